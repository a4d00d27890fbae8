"""The commit that is checked out, and what of the tree differs from it."""

import subprocess

from industnerf.errors import BadArtifact

# Written after a result is made; no score depends on them (the page shows results/grid, seeds).
RESULT_PATHS = ("dvc.lock", "results", "README.md", "docs")


def head_commit() -> str:
    """Its name, 40 digits; raises BadArtifact outside a repository, as does `changed_paths`."""
    return _git("rev-parse", "HEAD").strip()


def changed_paths() -> list[str]:
    """The paths that differ from it, new ones included; but for RESULT_PATHS."""
    exclusions = (f":(top,exclude){path}" for path in RESULT_PATHS)
    return [
        line[3:] for line in _git("status", "--porcelain", "--", ":/", *exclusions).splitlines()
    ]


def _git(*arguments: str) -> str:
    try:
        completed = subprocess.run(["git", *arguments], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        reason = (getattr(error, "stderr", "") or str(error)).strip()
        raise BadArtifact(f"no commit to publish under: git {arguments[0]}: {reason}") from None
    return completed.stdout
