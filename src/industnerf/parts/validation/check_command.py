"""`python -m industnerf.parts check`: defects of CAD files, found before a study uses them.

Each file is read and repaired in a process of its own, within the time and memory of params.yaml: a
file that hangs, crashes or eats memory costs itself only.
"""

import tempfile
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from rich.console import Console

from industnerf.artifacts.solids import Solids
from industnerf.errors import BAD_INPUT, BadParams
from industnerf.parts.contact_sheet import Tile, render_tile, write_contact_sheet
from industnerf.parts.io.cad_files import is_cad_file, name_files, unread_files
from industnerf.parts.io.ingest import used_appearances
from industnerf.parts.io.readers.formats import SUFFIXES
from industnerf.parts.validation.findings import (
    findings_table,
    short_name,
    verdict_lines,
    write_csv,
)
from industnerf.parts.validation.validate_file import Finding, load_findings, validate_file
from industnerf.progress import Progress
from industnerf.runner import runner_from_environment
from industnerf.schema import Params
from industnerf.store import Cost

COLUMNS = 6  # of the contact sheet
INTERRUPTED_EXIT_CODE = 130  # what a shell reports after Ctrl-C


def check_cad_files(paths: Sequence[Path], params: Params, out: Path, console: Console) -> int:
    """Print a table and verdicts, and write `check.csv` and `check.png` into `out`.

    Returns 0, 2 if a file is refused, or 130 after Ctrl-C: then for the files that were finished.
    Raises BadParams if a folder among `paths` holds no file that could be read, or `out` cannot be
    written.
    """
    files, unread = expand_folders(paths)
    _make_folder(out)
    results: dict[int, tuple[list[Finding], list[Tile]]] = {}
    code = 0
    with tempfile.TemporaryDirectory() as scratch:
        try:
            for number, file_findings, file_tiles in _validate_all(files, params, Path(scratch)):
                results[number] = file_findings, file_tiles
        except KeyboardInterrupt:
            code = INTERRUPTED_EXIT_CODE
    findings = [finding for number in sorted(results) for finding in results[number][0]]
    tiles = [tile for number in sorted(results) for tile in results[number][1]]
    if findings:
        _report(findings, tiles, unread, out, console)
    return code or (BAD_INPUT if any(finding.refused for finding in findings) else 0)


def expand_folders(paths: Sequence[Path]) -> tuple[list[Path], list[Path]]:
    """`paths`, with the files of every known type in place of each folder; and the others in it.

    Neither has hidden files, nor the others the sidecars of a CAD file.
    """
    files: list[Path] = []
    unread: list[Path] = []
    for path in paths:
        if not path.is_dir():
            files.append(path)
            continue
        others = unread_files(path, path.rglob("*"))
        cad_files = [p for p in sorted(path.rglob("*")) if is_cad_file(p, path)]
        if not cad_files:
            found = f"; it has {name_files(others)}" if others else ""
            raise BadParams(f"check: no file in {path} ends in {', '.join(SUFFIXES)}{found}")
        files += cad_files
        unread += others
    return files, unread


def _make_folder(out: Path) -> None:
    """Raises BadParams before any work if `out` cannot be written."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=out).close()
    except OSError as error:
        raise BadParams(f"check: --out {out}: cannot be written: {error.strerror}") from None


def _validate_all(
    files: Sequence[Path], params: Params, scratch: Path
) -> Iterator[tuple[int, list[Finding], list[Tile]]]:
    """The number, findings and tiles of each file, in the order in which they finish."""
    targets = [scratch / str(i) for i in range(len(files))]
    works = [partial(validate_file, f, params, t) for f, t in zip(files, targets, strict=True)]
    limits = params.parts.time_limit_s, params.parts.memory_limit_mb
    runner, labels = runner_from_environment(), [("", str(path)) for path in files]
    with Progress("check", labels, reused=0, workers=getattr(runner, "workers", 1)) as progress:
        for outcome in runner.map(works, *limits):
            path, target = files[outcome.index], targets[outcome.index]
            name = str(path)
            error = outcome.error and outcome.error.removeprefix(f"{path.name}: ")
            findings = (
                load_findings(target, name) if error is None else [Finding(name, refused=error)]
            )
            progress.advance(
                outcome.index, error, Cost(findings[0].seconds, findings[0].peak_mb, "cpu")
            )
            yield outcome.index, findings, _tiles(findings, target)


def _tiles(findings: Sequence[Finding], target: Path) -> list[Tile]:
    """A picture of each finding; a crossed box where there is nothing to see."""
    usable = any(not finding.refused for finding in findings)
    file = Solids.load(target) if usable else None
    meshes = iter(file.solids if file else ())
    tiles = []
    for finding in findings:
        caption = f"{short_name(finding)}\n{finding.verdict}"
        if finding.refused or file is None:
            tiles.append(Tile(caption, None))
        else:
            tiles.append(render_tile(caption, *used_appearances(next(meshes).mesh, file.finishes)))
    return tiles


def _report(
    findings: Sequence[Finding],
    tiles: Sequence[Tile],
    unread: Sequence[Path],
    out: Path,
    console: Console,
) -> None:
    write_csv(out / "check.csv", findings)
    write_contact_sheet(tiles, out / "check.png", COLUMNS)
    console.print(findings_table(findings))
    lines = list(verdict_lines(findings))
    if unread:
        lines.append(f"left out, for they are no CAD: {name_files(unread)}")
    for line in (*lines, f"written: {out / 'check.csv'}, {out / 'check.png'}"):
        console.print(line, markup=False, highlight=False, soft_wrap=True)
