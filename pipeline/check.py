"""Check params.yaml before DVC starts: `make repro` does.  Wrong keys and types end it at once."""

from pathlib import Path

from industnerf.cli import exit_with_message
from industnerf.config import load_params
from industnerf.parts.files import require_place


def main() -> None:
    require_place(Path(load_params().parts.path))


if __name__ == "__main__":
    exit_with_message(main)
