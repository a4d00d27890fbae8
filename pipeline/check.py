"""Check params.yaml and dvc.lock before DVC starts: `make repro` does.

Wrong keys and types end it at once, and so does a lock file that a kill has cut short.
"""

from pathlib import Path

from industnerf.cli import exit_with_message
from industnerf.config import load_params
from industnerf.doctor import lockfile
from industnerf.doctor.places import Places
from industnerf.parts.files import require_place


def main() -> None:
    require_place(Path(load_params().parts.path))
    places = Places.of(Path.cwd())
    lockfile.require_whole(places, places.root)


if __name__ == "__main__":
    exit_with_message(main)
