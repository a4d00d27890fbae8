"""Where a working copy keeps what can break."""

import shlex
from dataclasses import dataclass
from pathlib import Path

from industnerf import environment
from industnerf.store import Store


@dataclass(frozen=True)
class Project:
    """A DVC project: the repository itself, or the run of a preset."""

    folder: Path
    rerun_command: str  # brings it up to date; a command for the root

    @property
    def cache(self) -> Path:
        return self.folder / ".dvc" / "cache" / "files" / "md5"


@dataclass(frozen=True)
class ProjectPaths:
    """All paths are absolute."""

    root: Path
    store: Path
    database: Path

    @staticmethod
    def from_root(root: Path) -> "ProjectPaths":
        """Of the repository `root`, with store and database where INDUSTNERF_* say."""
        tracking = Path(environment.get_str("INDUSTNERF_MLFLOW") or root).absolute()
        return ProjectPaths(root.absolute(), Store.from_environment().root, tracking / "mlflow.db")

    def projects(self) -> list[Project]:
        """Every DVC project below the root."""
        presets = sorted(path.parent for path in self.root.glob("runs/*/.dvc"))
        root_project = [Project(self.root, "dvc repro")] if (self.root / ".dvc").is_dir() else []
        return root_project + [
            Project(path, f"python -m pipeline.preset {path.name}") for path in presets
        ]

    def shell_words(self, *paths: Path) -> str:
        """`paths` as words of a shell command, relative to the root where they are below it."""
        relative = [p.relative_to(self.root) if p.is_relative_to(self.root) else p for p in paths]
        return shlex.join(map(str, relative))
