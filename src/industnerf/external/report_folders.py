"""The folder of a report: one for each question, in which nobody else's files are touched."""

import shutil
from collections.abc import Iterable
from itertools import count
from pathlib import Path

from industnerf.artifacts.files import read_json, write_json
from industnerf.errors import BadArtifact, BadParams

# all that is ever written, beside REQUEST_FILE
OUTPUT_FOLDERS = ("solids", "parts", "truth", "clouds", "scores")
REQUEST_FILE = "request.json"  # of which clouds, and which part, the report is


def report_folder(root: Path, clouds: Path, part: str, sources: Iterable[Path]) -> Path:
    """The folder below `root` for the report of `clouds`, of `part` if it is named.

    That of the same question, if it was asked before; else the first of `clouds`, `clouds-2`, ...
    that is not there.  It is made, and notes at once of what it is: of two questions that
    are asked at the same time each has its own, and files of one name from two places do not
    replace each other's.
    Raises BadParams if one of the `sources`, which are read, lies where the report would go.
    """
    sources = tuple(sources)
    for folder in sorted(root.glob("*/")):
        if _read_request(folder) == (str(clouds), part):
            return _require_disjoint(folder, sources)
    name = (clouds.name if clouds.is_dir() else clouds.stem) or "root"
    names = (name if number == 1 else f"{name}-{number}" for number in count(1))
    root.mkdir(parents=True, exist_ok=True)
    folder = next(
        folder
        for candidate in names
        if _create_exclusively(folder := _require_disjoint(root / candidate, sources))
    )
    _write_request(folder, clouds, part)
    return folder


def _require_disjoint(folder: Path, sources: Iterable[Path]) -> Path:
    """`folder`; raises BadParams if one of the `sources` lies in it, or is it."""
    inside = [path for path in sources if path.resolve().is_relative_to(folder.resolve())]
    if inside:
        raise BadParams(
            f"{inside[0]} lies in {folder}, where its own report would go: move or rename it"
        )
    return folder


def start_report(folder: Path, clouds: Path, part: str) -> None:
    """Remove the report in `folder`, and nothing else there, and note what the next is of."""
    for name in OUTPUT_FOLDERS:
        shutil.rmtree(folder / name, ignore_errors=True)
    _write_request(folder, clouds, part)


def _write_request(folder: Path, clouds: Path, part: str) -> None:
    write_json(folder / REQUEST_FILE, {"schema": 1, "clouds": str(clouds), "part": part})


def _read_request(folder: Path) -> tuple[str, str] | None:
    """Of what the report in `folder` is; None where that is not noted, or not as it is here."""
    try:
        request = read_json(folder / REQUEST_FILE, 1, "score")
    except BadArtifact:
        return None
    return request.get("clouds"), request.get("part")


def _create_exclusively(folder: Path) -> bool:
    """Make `folder`; False if something is there, also if it came to be this very moment."""
    try:
        folder.mkdir()
    except FileExistsError:
        return False
    return True
