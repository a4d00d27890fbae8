"""Table 1 as files and for people."""

from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields

from industnerf.methods.base import Role
from industnerf.report import paper_results
from industnerf.report.part_subsets import SEED_PARTS
from industnerf.report.tables.formats import (
    csv_text,
    format_fixed,
    format_significant,
    label_intervals,
    markdown_table,
)
from industnerf.report.tables.table1 import Table1Row

SEEDS_COLUMN = "sd, seeds"
COLUMNS = (
    "method",
    "inputs",
    "views",
    "split",
    "EMD (even)",
    "95 %",
    SEEDS_COLUMN,
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
ONE_FAMILY_NOTE = (
    "Where all parts are of one family an interval has nothing to be drawn from: in its place "
    "stand the lowest and the highest part, and no difference can be told from chance."
)
HOLD_OUT_TEXTS = {"family": "of other families", "part": "others", "none": "and itself"}


@dataclass(frozen=True)
class Table1Extra:
    """What Table 1 shows beside its columns."""

    emd_without_failures: float | None
    seconds: float | None
    ratio_to_paper_method: float | None = None  # EMD (even) as a multiple of the paper's method's
    role: Role = Role.METHOD


def table1_csv(rows: list[Table1Row]) -> str:
    """`table1.csv`, one column a field of Row."""
    return csv_text([field.name for field in fields(Table1Row)], map(astuple, rows))


def format_row(row: Table1Row, extra: Table1Extra) -> list[str]:
    """`row` as people read it, one text for each of COLUMNS."""
    return [
        row.method,
        row.inputs,
        _format_views(row),
        row.split,
        format_fixed(row.emd_even),
        f"{row.ci_low:.4f} to {row.ci_high:.4f}",
        format_fixed(row.seeds_sd, 5),
        format_significant(row.emd_mm),
        format_fixed(row.floor),
        format_fixed(row.ratio_to_floor, 2),
        format_fixed(extra.ratio_to_paper_method, 2),
        format_fixed(row.emd_iid),
        format_fixed(row.emd_full),
        str(row.parts),
        str(row.failures),
        format_fixed(extra.emd_without_failures),
        format_fixed(extra.seconds, 2),
        describe_training(row),
        _format_paper_emd(row.paper_emd),
    ]


def _format_views(row: Table1Row) -> str:
    """Such as `40`, or `1 (8 answers)`; nothing where no picture of the part was given."""
    predictions = f" ({row.num_predictions} answers)" if row.num_predictions > 1 else ""
    return f"{row.views}{predictions}" if row.views else ""


def table1_notes(rows: Sequence[Table1Row]) -> list[str]:
    """What must be known to read Table 1, in words."""
    multi_prediction_rows = [
        row for row in rows if row.num_predictions > 1 and row.split == rows[0].split
    ]
    texts = [
        f"{row.method} is given one view at a time and asked {row.num_predictions} times: EMD (even) is "
        "the mean over its answers; EMD (iid), EMD (full), all pictures and the viewer are of the "
        f"first answer that has points.{_empty_predictions_note(row)}"
        for row in multi_prediction_rows
    ]
    if any(row.families < 2 for row in rows):
        texts.append(ONE_FAMILY_NOTE)
    if _has_seed_variance(rows):
        texts.append(
            f"{SEEDS_COLUMN}: standard deviation, over the seeds of experiment=seeds, of the mean EMD "
            f"(even) of {SEED_PARTS} fixed test parts (results/seeds); empty where it was not run, "
            "or where these parts have other EMDs than there."
        )
    return texts


def _empty_predictions_note(row: Table1Row) -> str:
    """Nothing if every answer has points."""
    if not row.empty_predictions:
        return ""
    return (
        f" {row.empty_predictions} of the {row.num_predictions * (row.parts - row.failures)} answers over the "
        f"{row.split} parts that did not fail have none: each scores as a failure, of one answer."
    )


def _has_seed_variance(rows: Sequence[Table1Row]) -> bool:
    """Whether any row has a spread over seeds."""
    return any(row.seeds_sd is not None for row in rows)


def _format_paper_emd(emd: float | None) -> str:
    """The paper's EMD, and which multiple of its own method's that is: `0.0482 (3.96 x)`."""
    return (
        "" if emd is None else f"{emd:.4f} ({emd / paper_results.EMD[paper_results.METHOD]:.2f} x)"
    )


def describe_training(row: Table1Row) -> str:
    """Such as `78 parts of other families, cpu: 1.2 M numbers, 4000 steps; undertrained: ...`."""
    if not row.num_train_parts:
        return ""
    parts = "part" if row.num_train_parts == 1 else "parts"
    text = f"{row.num_train_parts} {parts} {HOLD_OUT_TEXTS[row.hold_out]}"
    if row.size:
        text += f"; {row.size}, {row.parameters / 1e6:.2g} M numbers, {row.steps} steps"
    return text + (f"; **undertrained**: {row.undertrained}" if row.undertrained else "")


def table1_md(rows: list[Table1Row], extras: list[Table1Extra], interval: float) -> str:
    """`table1.md`: Table 1 with the seconds of cost.csv."""
    indices = [
        i for i, name in enumerate(COLUMNS) if name != SEEDS_COLUMN or _has_seed_variance(rows)
    ]
    heads = label_intervals([COLUMNS[i] for i in indices], interval)
    texts = [format_row(row, extra) for row, extra in zip(rows, extras, strict=True)]
    table = markdown_table(heads, [[text[i] for i in indices] for text in texts])
    return table + "".join(f"\n{text}\n" for text in table1_notes(rows))
