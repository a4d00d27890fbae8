"""Check params.yaml and dvc.lock before DVC starts: `make repro` does.

Wrong keys and types end it at once, and so does a lock file that a kill has cut short.
"""

from pathlib import Path

from industnerf.cli import exit_with_message
from industnerf.config import load_params
from industnerf.doctor import lockfile
from industnerf.doctor.project_paths import ProjectPaths
from industnerf.parts.io.cad_files import require_path


def main() -> None:
    require_path(Path(load_params().parts.path))
    project_paths = ProjectPaths.from_root(Path.cwd())
    lockfile.require_intact(project_paths, project_paths.root)


if __name__ == "__main__":
    exit_with_message(main)
