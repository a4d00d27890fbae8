"""Check params.yaml and dvc.lock before DVC starts: `make repro` does.

python -m pipeline.check

Wrong keys and types end it at once.  A lock file that a kill has cut short is set aside.
"""

from pathlib import Path

from industnerf.cli import run_command
from industnerf.config import load_params
from industnerf.doctor import lockfile
from industnerf.parts.io.cad_files import require_path


def main() -> None:
    require_path(Path(load_params().parts.path))
    lockfile.replace_torn(Path.cwd())


if __name__ == "__main__":
    run_command(main)
