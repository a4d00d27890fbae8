"""The goals of the suite on the test parts, and whether they are met.

The bounds are those of the design, set before the methods were written. Goals about clouds show the
same quantity for REFERENCE_METHODS: one is given true depth, one the true surface. No method can
reach a goal that the oracle misses. A mean length has a supplement in mm, mean seconds the share of
the parts that take longer than the bound, an error of depth the share of pixels that it is of.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from statistics import fmean

from industnerf.artifacts.scores import PartScore, Score
from industnerf.report import paper_results
from industnerf.report.statistics.comparisons import emd_even_by_part
from industnerf.report.study import Study
from industnerf.report.tables.costs import CostRow
from industnerf.report.tables.formats import csv_text, format_significant, markdown_table
from industnerf.report.tables.scores import (
    AUSE,
    AUSE_RANDOM,
    DEPTH_COVERAGE,
    EMD_EVEN,
    SPEARMAN,
    scores_of,
    select_scores,
    unit_in_mm,
    values_in_mm,
)

PLUS, HULL = "industnerf_plus", "hull"
REFERENCE_METHODS = ("tsdf", "oracle")
FULLY_VISIBLE = 0.98  # share of the surface seen by the reference rig that counts as all
POCKETS = "pockets"
MEAN_EMD = "EMD (even)"
FULLY_VISIBLE_EMD = (
    f"EMD (even) in floors, parts that the rig sees to {FULLY_VISIBLE:g} without pockets"
)
SHARE_ABOVE = "share of parts above"
CONFIDENCE_CORRELATION = "rank correlation of confidence with the distance to the truth"
MEMORY = "peak memory of any part, GB"
AUSE_SHARE = "AUSE of confidence, over that of a random order (0: of the true order)"

ScoresByPart = dict[str, Score]  # by part


@dataclass(frozen=True)
class SupplementaryValue:
    """A second value beside a mean."""

    value: float
    unit: str  # mm or mm^2: the same mean in mm; or SHARE_ABOVE: parts above the bound


@dataclass(frozen=True)
class Goal:
    """A value that is to be at most, or at least, a bound."""

    method: str
    quantity: str
    bound: float
    at_least: bool
    value: float
    reference_values: dict[str, float] = field(default_factory=dict)  # of REFERENCE_METHODS
    supplement: SupplementaryValue | None = None
    coverage: float | None = None  # of a depth: the share of the foreground that the error is of

    @property
    def is_met(self) -> bool:
        return self.value >= self.bound if self.at_least else self.value <= self.bound

    @property
    def target(self) -> str:
        return f"{'at least' if self.at_least else 'at most'} {self.bound:g}"


def evaluate_goals(study: Study, costs: Sequence[CostRow]) -> list[Goal]:
    """All goals that the study has the methods, and `costs`, for."""
    results = [*_cloud_goals(study)]
    for method in (paper_results.METHOD, PLUS):
        results += [*_image_goals(study, method), *_confidence_goals(study, method)]
        results += _cost_goals(study, costs, method)
    return results


def _cloud_goals(study: Study) -> Iterable[Goal]:
    """Goals about the EMD (even)."""
    hull = emd_even_by_part(study, HULL)
    targets: list[tuple[str, str, float, bool, Callable[[ScoresByPart], float | None]]] = [
        (paper_results.METHOD, MEAN_EMD, 0.020, False, _mean),
        (paper_results.METHOD, FULLY_VISIBLE_EMD, 1.4, False, partial(_mean_floor_ratio, study)),
        (PLUS, MEAN_EMD, 0.0122, False, _mean),
        (PLUS, "share of parts on which it beats the hull", 0.8, True, partial(_win_rate, hull)),
        (
            PLUS,
            "EMD of the hull over its own, parts with pockets",
            3.0,
            True,
            partial(_pocket_ratio, study, hull),
        ),
    ]
    for method, quantity, bound, at_least, measure in targets:
        names = (method, *REFERENCE_METHODS)
        values = {name: measure(emd_even_by_part(study, name)) for name in names}
        values_by_method = {name: value for name, value in values.items() if value is not None}
        if method in values_by_method:
            scores = select_scores(scores_of(study, method, "test"), *EMD_EVEN)
            supplement = _mm_supplement(study, scores) if quantity == MEAN_EMD else None
            yield Goal(
                method,
                quantity,
                bound,
                at_least,
                values_by_method.pop(method),
                values_by_method,
                supplement,
            )


def _mean(scores: ScoresByPart) -> float | None:
    return fmean(score.value for score in scores.values()) if scores else None


def _mean_floor_ratio(study: Study, scores: ScoresByPart) -> float | None:
    """Over parts that the reference rig sees to FULLY_VISIBLE, without pockets."""
    ratios = [
        score.value / score.floor
        for part, score in scores.items()
        if study.rig_visible_share.get(part, 0.0) >= FULLY_VISIBLE
        and POCKETS not in study.parts[part].strata
    ]
    return fmean(ratios) if ratios else None


def _win_rate(hull: ScoresByPart, scores: ScoresByPart) -> float | None:
    common = scores.keys() & hull.keys()
    return fmean(scores[part].value < hull[part].value for part in common) if common else None


def _pocket_ratio(study: Study, hull: ScoresByPart, scores: ScoresByPart) -> float | None:
    pocket_parts = [
        part for part in scores.keys() & hull.keys() if POCKETS in study.parts[part].strata
    ]
    if not pocket_parts:
        return None
    return fmean(hull[part].value for part in pocket_parts) / fmean(
        scores[part].value for part in pocket_parts
    )


def _mm_supplement(study: Study, scores: Sequence[PartScore]) -> SupplementaryValue | None:
    """The mean in mm; None if `scores`, all of one metric, are no lengths."""
    unit = unit_in_mm(scores)
    return SupplementaryValue(fmean(values_in_mm(study, scores)), unit) if unit else None


def _image_goals(study: Study, method: str) -> Iterable[Goal]:
    """Goals about held-out views, over the union of true and rendered foreground."""
    bounds = {
        "rgb_mse": ("RGB MSE of held-out views", 0.004, False),
        "depth_mse": ("depth MSE of held-out views, diagonal 1", 0.0005, False),
        "coverage": ("share of the foreground that has a depth", 0.98, True),
    }
    scores = scores_of(study, method, "test")
    for metric, (quantity, bound, at_least) in bounds.items():
        if rows := select_scores(scores, metric, "P1-union"):
            value = fmean(row.score.value for row in rows)
            goal = Goal(
                method, quantity, bound, at_least, value, supplement=_mm_supplement(study, rows)
            )
            covered = select_scores(scores, *DEPTH_COVERAGE) if metric == "depth_mse" else []
            yield replace(goal, coverage=_mean({row.part_id: row.score for row in covered}))


def _confidence_goals(study: Study, method: str) -> Iterable[Goal]:
    scores = scores_of(study, method, "test")
    means = {
        key: fmean(row.score.value for row in rows)
        for key in (SPEARMAN, AUSE, AUSE_RANDOM)
        if (rows := select_scores(scores, *key))
    }
    if SPEARMAN in means:
        yield Goal(method, CONFIDENCE_CORRELATION, -0.5, False, means[SPEARMAN])
    if means.get(AUSE_RANDOM):
        yield Goal(method, AUSE_SHARE, 1.0, False, means[AUSE] / means[AUSE_RANDOM])


def _cost_goals(study: Study, costs: Sequence[CostRow], method: str) -> Iterable[Goal]:
    method_costs = [
        row.cost
        for row in costs
        if (row.stage, row.method) == ("reconstruct", method)
        and (
            assignment := study.assignments.get(row.part_id)
        )  # of a published study it may have no score
        and assignment.split == "test"
    ]
    if not method_costs:
        return
    bound, seconds = 30.0, [cost.processor_seconds for cost in method_costs]
    supplement = SupplementaryValue(fmean(value > bound for value in seconds), SHARE_ABOVE)
    is_wall_time = any(cost.cpu_seconds is None for cost in method_costs)
    quantity = f"mean {'wall' if is_wall_time else 'processor'} seconds a part"
    yield Goal(method, quantity, bound, False, fmean(seconds), supplement=supplement)
    peak_gb = max(cost.peak_mb for cost in method_costs) * 2**20 / 1e9  # peak_mb counts MiB
    yield Goal(method, MEMORY, 2.0, False, peak_gb)


def add_capture_goals(goals: Sequence[Goal], published: Sequence[Mapping[str, str]]) -> list[Goal]:
    """`goals` with the published goal about fully visible parts, which scores alone do not give.

    `published` are the rows of a `goals.csv` of the same methods.
    """
    merged = list(goals)
    for index, row in enumerate(published):
        if row["goal"] == FULLY_VISIBLE_EMD:
            merged.insert(index, _parse_goal(row))
    return merged


def _parse_goal(row: Mapping[str, str]) -> Goal:
    direction, bound = row["target"].rsplit(" ", 1)
    # an older file lacks their columns
    reference_values = {name: float(row[name]) for name in REFERENCE_METHODS if row.get(name)}
    value, at_least = float(row["value"]), direction == "at least"
    return Goal(row["method"], row["goal"], float(bound), at_least, value, reference_values)


def goals_csv(goals: Sequence[Goal]) -> str:
    """`goals.csv`."""
    return csv_text(
        (
            "method",
            "goal",
            "target",
            "value",
            "met",
            "supplement",
            "unit",
            "coverage",
            *REFERENCE_METHODS,
        ),
        [
            (
                *(
                    goal.method,
                    goal.quantity,
                    goal.target,
                    goal.value,
                    "yes" if goal.is_met else "no",
                ),
                *((goal.supplement.value, goal.supplement.unit) if goal.supplement else ("", "")),
                goal.coverage,
                *(goal.reference_values.get(name) for name in REFERENCE_METHODS),
            )
            for goal in goals
        ],
    )


COLUMNS = ("method", "goal", "target", "measured", "met", "also", *REFERENCE_METHODS)


def format_row(goal: Goal) -> list[str]:
    """`goal` as text, one for each of COLUMNS."""
    references = [
        f"{goal.reference_values[name]:.3g}" if name in goal.reference_values else ""
        for name in REFERENCE_METHODS
    ]
    verdict = "yes" if goal.is_met else "**no**"
    return [
        goal.method,
        goal.quantity,
        goal.target,
        f"{goal.value:.3g}",
        verdict,
        _format_supplement(goal),
        *references,
    ]


def _format_supplement(goal: Goal) -> str:
    """Such as `3.35 mm`, or `29 % of parts above 30`."""
    if goal.supplement is None:
        return ""
    if goal.supplement.unit == SHARE_ABOVE:
        return f"{100 * goal.supplement.value:.0f} % of parts above {goal.bound:g}"
    text = f"{format_significant(goal.supplement.value)} {goal.supplement.unit.replace('^2', '²')}"
    return text if goal.coverage is None else f"{text}, coverage {goal.coverage:.3f}"


def goals_md(goals: Sequence[Goal]) -> str:
    """`goals.md`: the table, or why there is none."""
    placeholder = "No method that has goals ran, or there is no test part.\n"
    return markdown_table(COLUMNS, map(format_row, goals)) if goals else placeholder
