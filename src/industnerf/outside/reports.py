"""The folder of a report: one for each question, in which nobody else's files are touched."""

import shutil
from collections.abc import Iterable
from itertools import count
from pathlib import Path

from industnerf.artifacts.files import read_json, write_json
from industnerf.errors import BadArtifact, BadParams

MADE = ("solids", "parts", "truth", "clouds", "scores")  # all that is ever written, beside ASKED
ASKED = "asked.json"  # of which clouds, and which part, the report is


def folder_for(root: Path, place: Path, part: str, sources: Iterable[Path]) -> Path:
    """The folder below `root` for the report of the clouds at `place`, of `part` if it is named.

    That of the same question, if it was asked before; else the first of `clouds`, `clouds-2`, ...
    that is not there.  It is made, and notes at once of what it is: of two questions that
    are asked at the same time each has its own, and files of one name from two places do not
    replace each other's.
    Raises BadParams if one of the `sources`, which are read, lies where the report would go.
    """
    sources = tuple(sources)
    for folder in sorted(root.glob("*/")):
        if _asked(folder) == (str(place), part):
            return _apart(folder, sources)
    name = (place.name if place.is_dir() else place.stem) or "root"
    names = (name if number == 1 else f"{name}-{number}" for number in count(1))
    root.mkdir(parents=True, exist_ok=True)
    folder = next(folder for one in names if _claim(folder := _apart(root / one, sources)))
    _note(folder, place, part)
    return folder


def _apart(folder: Path, sources: Iterable[Path]) -> Path:
    """`folder`; raises BadParams if one of the `sources` lies in it, or is it."""
    inside = [path for path in sources if path.resolve().is_relative_to(folder.resolve())]
    if inside:
        raise BadParams(
            f"{inside[0]} lies in {folder}, where its own report would go: move or rename it"
        )
    return folder


def begin(folder: Path, place: Path, part: str) -> None:
    """Remove the report in `folder`, and nothing else there, and note what the next is of."""
    for name in MADE:
        shutil.rmtree(folder / name, ignore_errors=True)
    _note(folder, place, part)


def _note(folder: Path, place: Path, part: str) -> None:
    write_json(folder / ASKED, {"schema": 1, "place": str(place), "part": part})


def _asked(folder: Path) -> tuple[str, str] | None:
    """Of what the report in `folder` is; None where that is not noted, or not as it is here."""
    try:
        said = read_json(folder / ASKED, 1, "score")
    except BadArtifact:
        return None
    return said.get("place"), said.get("part")


def _claim(folder: Path) -> bool:
    """Make `folder`; False if something is there, also if it came to be this very moment."""
    try:
        folder.mkdir()
    except FileExistsError:
        return False
    return True
