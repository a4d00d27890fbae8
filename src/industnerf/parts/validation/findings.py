"""Findings about files as a terminal table, as sentences and as CSV."""

import csv
import io
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from rich import box
from rich.table import Table
from rich.text import Text

from industnerf.artifacts.files import write_text
from industnerf.parts.validation.validate_file import Finding

COLUMNS = (
    "file",
    "solid",
    "verdict",
    "refused",
    "format",
    "unit",
    "solids",
    "size_mm",
    "area_mm2",
    "volume_mm3",
    "bodies",
    "faces",
    "open_edges",
    "back_face_share",
    "repairs",
    "residual_defects",
    "notes",
    "seconds",
    "peak_mb",
)


def findings_table(findings: Sequence[Finding]) -> Table:
    """A row for each of `findings`; the sentences behind the counts are in `verdict_lines`."""
    grid = Table(title=_count_verdicts(findings), box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    grid.add_column("file\nformat (unit, ? if assumed), size in mm", overflow="fold")
    for heading in ("faces", "open\nedges", "back\nfaces", "repairs", "defects", "s", "MB"):
        grid.add_column(heading, justify="right", no_wrap=True)
    for finding in findings:
        cost = (f"{finding.seconds:.1f}", f"{finding.peak_mb:.0f}") if finding.peak_mb else ("", "")
        grid.add_row(_heading(finding), *_counts(finding), *cost)
    return grid


def _heading(finding: Finding) -> Text:
    size = " x ".join(f"{side:.4g}" for side in finding.size_mm)
    unit = finding.unit.replace(", assumed", "?").removesuffix(", stated")
    detail = "refused" if finding.refused else f"{finding.format} ({unit}), {size}"
    volume = "open" if finding.volume_mm3 is None else f"{finding.volume_mm3:.4g} mm\u00b3"
    bodies = "1 body" if finding.bodies == 1 else f"{finding.bodies} bodies"
    measured = f"\n{finding.area_mm2:.4g} mm\u00b2, {volume}, {bodies}"
    style = "red" if finding.refused else "dim"
    return Text.assemble(
        short_name(finding), "\n", (detail, style), ("" if finding.refused else measured, style)
    )


def _counts(finding: Finding) -> tuple[str, ...]:
    if finding.refused:
        return ("",) * 5
    return (
        str(finding.faces),
        str(finding.open_edges),
        f"{finding.back_face_share:.2%}",
        str(len(finding.repairs)),
        str(len(finding.residual_defects)),
    )


def short_name(finding: Finding) -> str:
    """The file without its folder, and the solid."""
    return (
        f"{Path(finding.file).name}: {finding.solid}" if finding.solid else Path(finding.file).name
    )


def _count_verdicts(findings: Sequence[Finding]) -> str:
    counts = Counter(finding.verdict for finding in findings)
    return ", ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items()))


def verdict_lines(findings: Sequence[Finding]) -> Iterator[str]:
    """A line for each of `findings`, and below it one for each repair, defect or note."""
    for finding in findings:
        yield f"{finding.name}: {finding.verdict}" + (
            f": {finding.refused}" if finding.refused else ""
        )
        yield from (f"    repair: {sentence}" for sentence in finding.repairs)
        yield from (f"    defect: {sentence}" for sentence in finding.residual_defects)
        yield from (f"    note: {sentence}" for sentence in finding.notes)


def write_csv(path: Path, findings: Sequence[Finding]) -> None:
    """One row for each of `findings`."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(COLUMNS)
    for finding in findings:
        rows.writerow([_cell(getattr(finding, column)) for column in COLUMNS])
    write_text(path, text.getvalue())


def _cell(value: object) -> str:
    """`value` with six digits; nothing for None, and a list with semicolons."""
    if isinstance(value, tuple):
        return "; ".join(map(_cell, value))
    if isinstance(value, float):
        return f"{value:.6g}"
    return "" if value is None else str(value)
