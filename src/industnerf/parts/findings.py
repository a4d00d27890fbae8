"""Findings about files, as a table for a terminal, as sentences, and as a spreadsheet."""

import csv
import io
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from rich import box
from rich.table import Table
from rich.text import Text

from industnerf.artifacts.files import write_text
from industnerf.parts.examine import Finding

COLUMNS = (
    "file",
    "solid",
    "verdict",
    "refused",
    "format",
    "unit",
    "solids",
    "size_mm",
    "faces",
    "open_edges",
    "back_face_share",
    "mended",
    "remaining",
    "note",
    "seconds",
    "peak_mb",
)


def table(findings: Sequence[Finding]) -> Table:
    """A row for each of `findings`; the sentences behind the counts are in `verdicts`."""
    grid = Table(title=_counted(findings), box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    grid.add_column("file\nformat (unit, ? if assumed), size in mm", overflow="fold")
    for heading in (
        "solids",
        "faces",
        "open\nedges",
        "back\nfaces",
        "mended",
        "remains",
        "s",
        "MB",
    ):
        grid.add_column(heading, justify="right", no_wrap=True)
    for found in findings:
        cost = (f"{found.seconds:.1f}", f"{found.peak_mb:.0f}") if found.peak_mb else ("", "")
        grid.add_row(_heading(found), *_counts(found), *cost)
    return grid


def _heading(found: Finding) -> Text:
    size = " x ".join(f"{side:.4g}" for side in found.size_mm)
    unit = found.unit.replace(", assumed", "?").removesuffix(", stated")
    below = "refused" if found.refused else f"{found.format} ({unit}), {size}"
    return Text.assemble(short_name(found), "\n", (below, "red" if found.refused else "dim"))


def _counts(found: Finding) -> tuple[str, ...]:
    if found.refused:
        return ("",) * 6
    return (
        str(found.solids),
        str(found.faces),
        str(found.open_edges),
        f"{found.back_face_share:.2%}",
        str(len(found.mended)),
        str(len(found.remaining)),
    )


def short_name(found: Finding) -> str:
    """The file without its folder, and the solid."""
    return f"{Path(found.file).name}: {found.solid}" if found.solid else Path(found.file).name


def _counted(findings: Sequence[Finding]) -> str:
    counts = Counter(finding.verdict for finding in findings)
    return ", ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items()))


def verdicts(findings: Sequence[Finding]) -> Iterator[str]:
    """A line for each of `findings`, and below it one for each thing mended, left or to note."""
    for found in findings:
        yield f"{found.name}: {found.verdict}" + (f": {found.refused}" if found.refused else "")
        yield from (f"    mended: {sentence}" for sentence in found.mended)
        yield from (f"    remains: {sentence}" for sentence in found.remaining)
        yield from (f"    note: {sentence}" for sentence in (found.note,) if sentence)


def write_csv(path: Path, findings: Sequence[Finding]) -> None:
    """One row for each of `findings`."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(COLUMNS)
    for found in findings:
        rows.writerow([_cell(getattr(found, column)) for column in COLUMNS])
    write_text(path, text.getvalue())


def _cell(value: object) -> object:
    if not isinstance(value, tuple):
        return value
    return "; ".join(f"{v:.6g}" if isinstance(v, float) else str(v) for v in value)
