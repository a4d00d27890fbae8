"""Table 1 as files and for people."""

from dataclasses import astuple, dataclass, fields

from industnerf.methods.base import Role
from industnerf.report import paper
from industnerf.report.formats import brief, csv_text, intervals_of, markdown, short
from industnerf.report.table1 import Row

COLUMNS = (
    "method",
    "inputs",
    "split",
    "EMD (even)",
    "95 %",
    "EMD, mm",
    "floor",
    "x floor",
    "x industnerf",
    "EMD (iid)",
    "EMD (full)",
    "parts",
    "failed",
    "without failures",
    "s a part",
    "learned from",
    "paper",
)
HELD_OUT = {"family": "of other families", "part": "others", "none": "and itself"}


@dataclass(frozen=True)
class Extra:
    """What Table 1 shows beside its columns."""

    emd_without_failures: float | None
    seconds: float | None
    to_ours: float | None = None  # EMD (even) as a multiple of the paper's method's
    role: Role = Role.METHOD


def table1_csv(rows: list[Row]) -> str:
    """`table1.csv`, one column a field of Row."""
    return csv_text([field.name for field in fields(Row)], map(astuple, rows))


def cells(row: Row, extra: Extra) -> list[str]:
    """`row` as people read it, one text for each of COLUMNS."""
    return [
        row.method,
        row.inputs,
        row.split,
        short(row.emd_even),
        f"{row.ci_low:.4f} to {row.ci_high:.4f}",
        brief(row.emd_mm),
        short(row.floor),
        short(row.ratio_to_floor, 2),
        short(extra.to_ours, 2),
        short(row.emd_iid),
        short(row.emd_full),
        str(row.parts),
        str(row.failures),
        short(extra.emd_without_failures),
        short(extra.seconds, 2),
        lesson(row),
        _published(row.paper_emd),
    ]


def _published(emd: float | None) -> str:
    """The paper's EMD, and which multiple of its own method's that is: `0.0482 (3.96 x)`."""
    return "" if emd is None else f"{emd:.4f} ({emd / paper.EMD[paper.OURS]:.2f} x)"


def lesson(row: Row) -> str:
    """Such as `78 parts of other families, cpu: 1.2 M numbers, 4000 steps; undertrained: ...`."""
    if not row.learned_from:
        return ""
    parts = "part" if row.learned_from == 1 else "parts"
    text = f"{row.learned_from} {parts} {HELD_OUT[row.hold_out]}"
    if row.size:
        text += f"; {row.size}, {row.parameters / 1e6:.2g} M numbers, {row.steps} steps"
    return text + (f"; **undertrained**: {row.undertrained}" if row.undertrained else "")


def table1_md(rows: list[Row], extras: list[Extra], interval: float) -> str:
    """`table1.md`: Table 1 with the seconds of cost.csv."""
    lines = [cells(row, extra) for row, extra in zip(rows, extras, strict=True)]
    return markdown(intervals_of(COLUMNS, interval), lines)
