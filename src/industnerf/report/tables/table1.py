"""Table 1: the paper's, with floors and intervals."""

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields, replace
from statistics import fmean

from industnerf.artifacts.scores import PartScore, Score
from industnerf.artifacts.truth import FLOOR_ERROR
from industnerf.methods.base import Method, Role
from industnerf.report import paper_results
from industnerf.report.part_subsets import SEED_PARTS
from industnerf.report.statistics.significance import bootstrap_interval
from industnerf.report.study import Study, TrainingSummary
from industnerf.report.tables.formats import (
    csv_text,
    format_fixed,
    format_interval,
    format_significant,
    label_intervals,
    markdown_table,
)
from industnerf.report.tables.scores import EMD_EVEN, scores_of, select_scores, values_in_mm
from industnerf.schema import ReportParams

MUST_BEAT = ("retrieval", "mean_shape")  # else a network is undertrained
STILL_TRAINING = "still learning"


@dataclass(frozen=True)
class Table1Row:
    """One method over the parts of one split."""

    method: str
    scope: str
    inputs: str
    split: str
    preset: str
    views: int  # per prediction
    emd_even: float
    ci_low: float | None  # None: one family has no interval
    ci_high: float | None
    floor: float
    ratio_to_floor: float
    emd_iid: float
    emd_full: float
    parts: int
    failures: int
    parameters: int
    steps: int
    paper_emd: float | None
    size: str  # of a network: full is as published
    num_train_parts: int  # the fewest of any fold
    hold_out: str  # what the training parts do not share with the part predicted
    undertrained: str  # the reasons, or empty
    emd_mm: float  # EMD (even), mean of the parts in mm
    num_predictions: int  # EMD (even) is their mean; the others are of the first with points
    seeds_sd: float | None  # of the mean EMD (even) over seeds, where known
    empty_predictions: int | None  # over the parts that did not fail; each scores as a failure
    families: int
    floor_se: float | None  # standard error of `floor`, where known
    imprecise_floors: int  # parts with a floor whose own error is above that asked for


def table1_rows(study: Study, settings: ReportParams) -> list[Table1Row]:
    """A row per split and method, test parts first, the best method first within a split."""
    rows = [
        _table1_row(study, settings, method, split, scores)
        for split in ("test", "dev")
        for method in study.methods.values()
        if (scores := scores_of(study, method.name, split))
    ]
    marked = [replace(row, undertrained=undertrained_reason(study, row, rows)) for row in rows]
    return sorted(marked, key=lambda row: (row.split != "test", row.emd_even))


def undertrained_reason(study: Study, row: Table1Row, rows: list[Table1Row]) -> str:
    """Why the network of `row` is undertrained; empty if it is not, or there is no network."""
    if not row.size:
        return ""
    reasons = [] if study.training_summaries[row.method].has_converged else [STILL_TRAINING]
    reasons += [
        f"no better than {other.method}"
        for other in rows
        if other.method in MUST_BEAT and other.split == row.split and other.emd_even <= row.emd_even
    ]
    return ", ".join(reasons)


def _table1_row(
    study: Study, settings: ReportParams, method: Method, split: str, scores: list[PartScore]
) -> Table1Row:
    even_scores = select_scores(scores, *EMD_EVEN)
    values = [row.score.value for row in even_scores]
    families = [study.parts[row.part_id].family for row in even_scores]
    low, high = bootstrap_interval(values, families, settings, study.seed)
    floor = fmean(row.score.floor for row in even_scores)
    floor_errors = [row.score.floor_se for row in even_scores if row.score.floor_se is not None]
    is_known = len(floor_errors) == len(even_scores)
    parameters, steps = study.parameters_and_steps[method.name]
    size, num_train_parts, hold_out = _summary_fields(study.training_summaries.get(method.name))
    return Table1Row(
        method=method.name,
        scope=method.scope.value,
        inputs=inputs_label(method),
        split=split,
        preset=study.preset,
        views=study.input_views[method.name].views_per_prediction,
        emd_even=fmean(values),
        ci_low=low,
        ci_high=high,
        floor=floor,
        ratio_to_floor=fmean(values) / floor,
        emd_iid=_mean(scores, "P1-iid"),
        emd_full=_mean(scores, "P1-full"),
        parts=len(even_scores),
        failures=sum(row.score.status != "ok" for row in even_scores),
        parameters=parameters,
        steps=steps,
        paper_emd=paper_results.EMD.get(method.name),
        size=size,
        num_train_parts=num_train_parts,
        hold_out=hold_out,
        undertrained="",
        emd_mm=fmean(values_in_mm(study, even_scores)),
        num_predictions=study.input_views[method.name].num_predictions,
        empty_predictions=study.empty_predictions.get((method.name, split)),
        families=len(set(families)),
        floor_se=math.hypot(*floor_errors) / len(even_scores) if is_known else None,
        imprecise_floors=len({row.part_id for row in scores if _has_imprecise_floor(row.score)}),
        seeds_sd=study.seeds_sd.get(method.name) if split == "test" else None,
    )


def _has_imprecise_floor(score: Score) -> bool:
    return score.metric == EMD_EVEN[0] and (score.floor_se or 0.0) > FLOOR_ERROR * score.floor


def _summary_fields(summary: TrainingSummary | None) -> tuple[str, int, str]:
    return (
        ("", 0, "")
        if summary is None
        else (summary.model_size, summary.num_train_parts, summary.hold_out)
    )


def inputs_label(method: Method) -> str:
    """The declared inputs, with the role of a null or a bound."""
    names = " + ".join(sorted(method.inputs))
    return names if method.role == Role.METHOD else f"{names} ({method.role.value})"


def _mean(scores: list[PartScore], protocol: str) -> float:
    return fmean(row.score.value for row in select_scores(scores, "emd", protocol))


def mean_without_failures(study: Study, row: Table1Row) -> float | None:
    """Mean EMD (even) over the parts that did not fail."""
    even_scores = select_scores(scores_of(study, row.method, row.split), *EMD_EVEN)
    values = [score_row.score.value for score_row in even_scores if score_row.score.status == "ok"]
    return fmean(values) if values else None


def ratio_to_paper_method(rows: list[Table1Row], row: Table1Row) -> float | None:
    """EMD (even) of `row` over that of the paper's method on the same parts, if it ran."""
    reference_emds = [
        other.emd_even
        for other in rows
        if (other.method, other.split) == (paper_results.METHOD, row.split)
    ]
    return row.emd_even / reference_emds[0] if reference_emds else None


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
