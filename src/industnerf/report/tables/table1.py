"""Table 1: the paper's, with floors and intervals."""

import math
from dataclasses import dataclass, replace
from statistics import fmean

from industnerf.artifacts.scores import PartScore, Score
from industnerf.artifacts.truth import FLOOR_ERROR
from industnerf.methods.base import Method, Role
from industnerf.report import paper_results
from industnerf.report.statistics.significance import bootstrap_interval
from industnerf.report.study import Study, TrainingSummary
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
