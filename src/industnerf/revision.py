"""The commit that is checked out, and what of the tree differs from it."""

import subprocess

from industnerf.errors import BadArtifact

# Written after a result is made; no score depends on them (the page shows results/grid, seeds).
LATER = ("dvc.lock", "results", "README.md", "docs")


def commit() -> str:
    """Its name, 40 digits; raises BadArtifact outside a repository, as does `changed`."""
    return _git("rev-parse", "HEAD").strip()


def changed() -> list[str]:
    """The paths that differ from it, new ones included; but for LATER."""
    but = (f":(top,exclude){path}" for path in LATER)
    return [line[3:] for line in _git("status", "--porcelain", "--", ":/", *but).splitlines()]


def _git(*arguments: str) -> str:
    try:
        done = subprocess.run(["git", *arguments], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        why = (getattr(error, "stderr", "") or str(error)).strip()
        raise BadArtifact(f"no commit to publish under: git {arguments[0]}: {why}") from None
    return done.stdout
