"""Table 1 as text: CSV, Markdown and the notes below it."""

from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields

from industnerf.artifacts.truth import FLOOR_ERROR
from industnerf.methods.base import Role
from industnerf.report import paper_results
from industnerf.report.part_subsets import SEED_PARTS
from industnerf.report.tables.formats import (
    csv_text,
    format_fixed,
    format_interval,
    format_significant,
    label_intervals,
    markdown_table,
)
from industnerf.report.tables.table1 import Table1Row

SEEDS_COLUMN = "sd, seeds"
COLUMNS = (
    *("method", "inputs", "views", "split", "EMD (even)", "95 %", SEEDS_COLUMN, "EMD, mm", "floor"),
    *("floor, se", "x floor", "x industnerf", "EMD (iid)", "EMD (full)", "parts", "failed"),
    *("without failures", "s a part", "learned from", "paper"),
)
ONE_FAMILY_NOTE = "Where all parts are of one family there is no interval."
HOLD_OUT_TEXTS = {"family": "of other families", "part": "others", "none": "and itself"}


@dataclass(frozen=True)
class Table1Extra:
    """What Table 1 shows beside the fields of its rows."""

    emd_without_failures: float | None
    seconds: float | None  # of the processor, or by the clock where `is_wall_time`
    ratio_to_paper_method: float | None = None  # EMD (even) as a multiple of the paper's method's
    role: Role = Role.METHOD
    is_wall_time: bool = False  # the results are older than the record of processor time


def table1_csv(rows: list[Table1Row]) -> str:
    """`table1.csv`, a column per field of Table1Row."""
    return csv_text([field.name for field in fields(Table1Row)], map(astuple, rows))


def format_row(row: Table1Row, extra: Table1Extra) -> list[str]:
    """`row` as text, one for each of COLUMNS."""
    return [
        row.method,
        row.inputs,
        _format_views(row),
        row.split,
        format_fixed(row.emd_even),
        format_interval(row.ci_low, row.ci_high, ".4f"),
        format_fixed(row.seeds_sd, 5),
        format_significant(row.emd_mm),
        format_fixed(row.floor),
        format_fixed(row.floor_se, 5),
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
    """Such as `40` or `1 (8 predictions)`; empty if the method sees no image of the part."""
    predictions = f" ({row.num_predictions} predictions)" if row.num_predictions > 1 else ""
    return f"{row.views}{predictions}" if row.views else ""


def table1_notes(rows: Sequence[Table1Row]) -> list[str]:
    """The notes below Table 1."""
    multi_prediction_rows = [
        row for row in rows if row.num_predictions > 1 and row.split == rows[0].split
    ]
    texts = [
        f"{row.method} predicts {row.num_predictions} times, from one view each. EMD (even) is the "
        "mean over its predictions; EMD (iid), EMD (full), the figures and the viewer are of the "
        f"first prediction that has points.{_empty_predictions_note(row)}"
        for row in multi_prediction_rows
    ]
    texts += [
        f"The floors of {row.imprecise_floors} {row.split} parts have a standard error above "
        f"{100 * FLOOR_ERROR:g} % after as many draws as allowed: floor_se in scores.csv."
        for row in {row.split: row for row in rows if row.imprecise_floors}.values()
    ]
    if any(row.families < 2 for row in rows):
        texts.append(ONE_FAMILY_NOTE)
    if _has_seed_variance(rows):
        texts.append(
            f"{SEEDS_COLUMN}: standard deviation of the mean EMD (even) of {SEED_PARTS} fixed test "
            "parts over the seeds of experiment=seeds (results/seeds). It is empty for methods "
            "that were not run there, or had other EMDs."
        )
    return texts


def _empty_predictions_note(row: Table1Row) -> str:
    """Empty if every prediction has points."""
    if not row.empty_predictions:
        return ""
    predictions = row.num_predictions * (row.parts - row.failures)
    return (
        f" {row.empty_predictions} of the {predictions} predictions over the {row.split} parts "
        "that did not fail have none; each of them scores as a failure."
    )


def _has_seed_variance(rows: Sequence[Table1Row]) -> bool:
    """Whether any row has a standard deviation over seeds."""
    return any(row.seeds_sd is not None for row in rows)


def _format_paper_emd(emd: float | None) -> str:
    """The paper's EMD, and its ratio to the paper's method, such as `0.0482 (3.96 x)`."""
    return (
        "" if emd is None else f"{emd:.4f} ({emd / paper_results.EMD[paper_results.METHOD]:.2f} x)"
    )


def describe_training(row: Table1Row) -> str:
    """Such as `78 parts of other families; cpu, 1.2 M parameters, 4000 steps`."""
    if not row.num_train_parts:
        return ""
    parts = "part" if row.num_train_parts == 1 else "parts"
    text = f"{row.num_train_parts} {parts} {HOLD_OUT_TEXTS[row.hold_out]}"
    if row.size:
        text += f"; {row.size}, {row.parameters / 1e6:.2g} M parameters, {row.steps} steps"
    return text + (f"; **undertrained**: {row.undertrained}" if row.undertrained else "")


def table1_md(rows: list[Table1Row], extras: list[Table1Extra], interval: float) -> str:
    """`table1.md`: Table 1 with the seconds of cost.csv."""
    indices = [
        i for i, name in enumerate(COLUMNS) if name != SEEDS_COLUMN or _has_seed_variance(rows)
    ]
    heads = label_intervals([COLUMNS[i] for i in indices], interval)
    texts = [format_row(row, extra) for row, extra in zip(rows, extras, strict=True)]
    table = markdown_table(heads, [[text[i] for i in indices] for text in texts])
    seconds = [extra for extra in extras if extra.seconds is not None]
    kind = "wall" if any(extra.is_wall_time for extra in seconds) else "processor"
    notes = [*([f"s a part: {kind} seconds."] if seconds else []), *table1_notes(rows)]
    return table + "".join(f"\n{text}\n" for text in notes)
