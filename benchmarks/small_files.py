"""What the measurements of scaling make, in a module of its own: the store must find its code."""

from pathlib import Path


def fill(files: int, target: Path) -> None:
    """So many small files, all different."""
    for i in range(files):
        (target / f"{i:03}").write_text(f"{target.name} {i}")
