"""Table 1 as files and for people."""

from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields

from industnerf.methods.base import Role
from industnerf.report import paper
from industnerf.report.formats import brief, csv_text, intervals_of, markdown, short
from industnerf.report.subsets import SEED_PARTS
from industnerf.report.table1 import Row

SEEDS = "sd, seeds"
COLUMNS = (
    "method",
    "inputs",
    "views",
    "split",
    "EMD (even)",
    "95 %",
    SEEDS,
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
ONE_FAMILY = (
    "Where all parts are of one family an interval has nothing to be drawn from: in its place "
    "stand the lowest and the highest part, and no difference can be told from chance."
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
        _views(row),
        row.split,
        short(row.emd_even),
        f"{row.ci_low:.4f} to {row.ci_high:.4f}",
        short(row.seeds_sd, 5),
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


def _views(row: Row) -> str:
    """Such as `40`, or `1 (8 answers)`; nothing where no picture of the part was given."""
    answers = f" ({row.answers} answers)" if row.answers > 1 else ""
    return f"{row.views}{answers}" if row.views else ""


def notes(rows: Sequence[Row]) -> list[str]:
    """What must be known to read Table 1, in words."""
    several = [row for row in rows if row.answers > 1 and row.split == rows[0].split]
    found = [
        f"{row.method} is given one view at a time and asked {row.answers} times: EMD (even) is "
        "the mean over its answers; EMD (iid), EMD (full), all pictures and the viewer are of the "
        f"first answer that has points.{_empty(row)}"
        for row in several
    ]
    if any(row.families < 2 for row in rows):
        found.append(ONE_FAMILY)
    if _seeds(rows):
        found.append(
            f"{SEEDS}: standard deviation, over the seeds of experiment=seeds, of the mean EMD "
            f"(even) of {SEED_PARTS} fixed test parts (results/seeds); empty where it was not run, "
            "or where these parts have other EMDs than there."
        )
    return found


def _empty(row: Row) -> str:
    """Nothing if every answer has points."""
    if not row.empty_answers:
        return ""
    return (
        f" {row.empty_answers} of the {row.answers * (row.parts - row.failures)} answers over the "
        f"{row.split} parts that did not fail have none: each scores as a failure, of one answer."
    )


def _seeds(rows: Sequence[Row]) -> bool:
    """Whether any row has a spread over seeds."""
    return any(row.seeds_sd is not None for row in rows)


def _published(emd: float | None) -> str:
    """The paper's EMD, and which multiple of its own method's that is: `0.0482 (3.96 x)`."""
    return "" if emd is None else f"{emd:.4f} ({emd / paper.EMD[paper.METHOD]:.2f} x)"


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
    shown = [i for i, name in enumerate(COLUMNS) if name != SEEDS or _seeds(rows)]
    heads = intervals_of([COLUMNS[i] for i in shown], interval)
    texts = [cells(row, extra) for row, extra in zip(rows, extras, strict=True)]
    table = markdown(heads, [[text[i] for i in shown] for text in texts])
    return table + "".join(f"\n{text}\n" for text in notes(rows))
