"""Check params.yaml before DVC starts: `make repro` does.  Wrong keys and types end it at once."""

from pathlib import Path

from industnerf.cli import exit_with_message
from industnerf.config import load_params
from industnerf.errors import BadParams


def main() -> None:
    folder = load_params().parts.path
    if not Path(folder).is_dir():
        raise BadParams(f"params.yaml: parts.path {folder!r} is not a folder")


if __name__ == "__main__":
    exit_with_message(main)
