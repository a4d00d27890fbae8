"""`python -m industnerf.parts check`: what is the matter with CAD files, before a study uses them.

Each file is read and cleaned in a process of its own, within the time and memory of params.yaml: a
file that hangs, crashes or eats memory costs itself only.
"""

import tempfile
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from rich.console import Console

from industnerf.artifacts.solids import Solids
from industnerf.errors import BadParams
from industnerf.parts.examine import Finding, examine, findings_of
from industnerf.parts.files import is_cad
from industnerf.parts.findings import short_name, table, verdicts, write_csv
from industnerf.parts.ingest import used_finishes
from industnerf.parts.reading.formats import SUFFIXES
from industnerf.parts.sheet import Tile, contact_sheet, tile_of
from industnerf.progress import Progress
from industnerf.runner import runner_from_environment
from industnerf.schema import PartsParams
from industnerf.store import Cost

COLUMNS = 6  # of the contact sheet
INTERRUPTED = 130  # what a shell reports after Ctrl-C


def check(paths: Sequence[Path], settings: PartsParams, out: Path, console: Console) -> int:
    """Print a table and verdicts, and write `check.csv` and `check.png` into `out`.

    Returns 0, 1 if a file is refused, or 130 after Ctrl-C: then for the files that were finished.
    Raises BadParams if a folder among `paths` holds no file that could be read, or `out` cannot be
    written.
    """
    files = find_files(paths)
    _make_folder(out)
    done: dict[int, tuple[list[Finding], list[Tile]]] = {}
    code = 0
    with tempfile.TemporaryDirectory() as scratch:
        try:
            for number, found, pictures in _look_at_all(files, settings, Path(scratch)):
                done[number] = found, pictures
        except KeyboardInterrupt:
            code = INTERRUPTED
    findings = [finding for number in sorted(done) for finding in done[number][0]]
    tiles = [tile for number in sorted(done) for tile in done[number][1]]
    if findings:
        _report(findings, tiles, out, console)
    return code or int(any(finding.refused for finding in findings))


def find_files(paths: Sequence[Path]) -> list[Path]:
    """`paths`, with the files of every known type in place of each folder; no hidden ones."""
    files: list[Path] = []
    for path in paths:
        below = [p for p in sorted(path.rglob("*")) if is_cad(p, path)]
        if path.is_dir() and not below:
            raise BadParams(f"check: no file in {path} ends in {', '.join(SUFFIXES)}")
        files += below if path.is_dir() else [path]
    return files


def _make_folder(out: Path) -> None:
    """Before any work is done that could then not be written."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=out).close()
    except OSError as error:
        raise BadParams(f"check: --out {out}: cannot be written: {error.strerror}") from None


def _look_at_all(
    files: Sequence[Path], settings: PartsParams, scratch: Path
) -> Iterator[tuple[int, list[Finding], list[Tile]]]:
    """The number of each file, with what there is to say and to see of it, once that is known."""
    targets = [scratch / str(i) for i in range(len(files))]
    works = [
        partial(examine, f, settings.units, settings.split_bodies, settings.clean, t)
        for f, t in zip(files, targets, strict=True)
    ]
    outcomes = runner_from_environment().map(works, settings.time_limit_s, settings.memory_limit_mb)
    with Progress("check", "check", len(files), reused=0) as progress:
        for outcome in outcomes:
            path, target = files[outcome.index], targets[outcome.index]
            name = str(path)
            error = outcome.error and outcome.error.removeprefix(f"{path.name}: ")
            found = findings_of(target, name) if error is None else [Finding(name, refused=error)]
            progress.advance(name, error, Cost(found[0].seconds, found[0].peak_mb, "cpu"))
            yield outcome.index, found, _tiles(found, target)


def _tiles(found: Sequence[Finding], target: Path) -> list[Tile]:
    """A picture of each finding; a crossed box where there is nothing to see."""
    usable = any(not finding.refused for finding in found)
    file = Solids.load(target) if usable else None
    meshes = iter(file.solids if file else ())
    tiles = []
    for finding in found:
        caption = f"{short_name(finding)}\n{finding.verdict}"
        if finding.refused or file is None:
            tiles.append(Tile(caption, None))
        else:
            tiles.append(tile_of(caption, *used_finishes(next(meshes).mesh, file.finishes)))
    return tiles


def _report(
    findings: Sequence[Finding], tiles: Sequence[Tile], out: Path, console: Console
) -> None:
    write_csv(out / "check.csv", findings)
    contact_sheet(tiles, out / "check.png", COLUMNS)
    console.print(table(findings))
    for line in (*verdicts(findings), f"written: {out / 'check.csv'}, {out / 'check.png'}"):
        console.print(line, markup=False, highlight=False, soft_wrap=True)
