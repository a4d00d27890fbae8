"""The goals of the suite on the test parts, and whether they are met.

Each bound is set before the study that it judges. Goals about clouds show the same quantity for
REFERENCE_METHODS: one is given true depth, one the true surface. No method can reach a goal that
the oracle misses. A mean length has a supplement in mm, an error of depth the share of pixels that
it is of.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from industnerf.report import paper_results
from industnerf.report.study import Study
from industnerf.report.tables.costs import CostRow
from industnerf.report.tables.formats import csv_text, format_significant, markdown_table
from industnerf.report.tables.method_results import (
    FULLY_VISIBLE,
    POCKETS,
    MethodResults,
    MetricKey,
)
from industnerf.report.tables.scores import DEPTH_COVERAGE, EMD_EVEN, SPEARMAN

REFERENCE_METHODS = ("tsdf", "oracle")
MEAN_EMD = "EMD (even)"
FULLY_VISIBLE_EMD = (
    f"EMD (even) in floors, parts that the rig sees to {FULLY_VISIBLE:g} without pockets"
)
CONFIDENCE_CORRELATION = "rank correlation of confidence with the distance to the truth"
MAX_CORRELATION = -0.5
AUSE_SHARE = "AUSE of confidence, over that of a random order (0: of the true order)"
MEAN_SECONDS = "seconds a part, mean"
SLOW_SECONDS = "seconds that nine parts in ten stay below"
MEMORY = "peak memory of any part, GB"
RGB_MSE, DEPTH_MSE = ("rgb_mse", "P1-union"), ("depth_mse", "P1-union")
CLEARLY_WORSE = 1.05  # times the EMD of another method


@dataclass(frozen=True)
class Target:
    """A bound, and how what it bounds is measured; None: it is not known."""

    quantity: str
    bound: float
    measure: Callable[[MethodResults], float | None]
    at_least: bool = False
    is_of_cloud: bool = False  # so that REFERENCE_METHODS have it too
    metric_key: MetricKey | None = None  # whose mean it is, if that is a length


def _mean_emd_target(bound: float) -> Target:
    return Target(
        MEAN_EMD, bound, lambda own: own.mean(EMD_EVEN), is_of_cloud=True, metric_key=EMD_EVEN
    )


def _nerf_targets(depth_mse: float, coverage: float, memory_gb: float) -> list[Target]:
    """Held-out views, over the union of true and rendered foreground, confidence and cost."""
    return [
        Target("RGB MSE of held-out views", 0.004, lambda own: own.mean(RGB_MSE)),
        Target(
            "depth MSE of held-out views, diagonal 1",
            depth_mse,
            lambda own: own.mean(DEPTH_MSE),
            metric_key=DEPTH_MSE,
        ),
        Target(
            "share of the foreground that has a depth",
            coverage,
            lambda own: own.mean(DEPTH_COVERAGE),
            at_least=True,
        ),
        Target(CONFIDENCE_CORRELATION, MAX_CORRELATION, lambda own: own.mean(SPEARMAN)),
        Target(AUSE_SHARE, 1.0, MethodResults.ause_share),
        Target(MEAN_SECONDS, 22.0, MethodResults.mean_seconds),
        Target(SLOW_SECONDS, 30.0, MethodResults.slow_seconds),
        Target(MEMORY, memory_gb, MethodResults.peak_gb),
    ]


def _covered_target(limit: str, bound: float) -> Target:
    return Target(
        f"share of the surface within {limit} mm",
        bound,
        lambda own: own.mean((f"covered_{limit}mm", "P1-dense")),
        at_least=True,
        is_of_cloud=True,
    )


def _hull_over_own(own: MethodResults) -> float | None:
    ratio = own.ratio_to("hull", POCKETS)
    return 1 / ratio if ratio else None


def _network_targets(bound: float) -> list[Target]:
    return [
        _mean_emd_target(bound),
        Target("EMD over that of retrieval", 1.0, lambda own: own.ratio_to("retrieval")),
    ]


TARGETS: dict[str, list[Target]] = {
    paper_results.METHOD: [
        _mean_emd_target(0.020),
        Target(FULLY_VISIBLE_EMD, 1.4, MethodResults.fully_visible_floors, is_of_cloud=True),
        *_nerf_targets(depth_mse=0.0005, coverage=0.98, memory_gb=2.0),
    ],
    "industnerf_plus": [
        _mean_emd_target(0.0137),
        Target(
            "EMD (even) in floors, worst part", 3.0, MethodResults.worst_floors, is_of_cloud=True
        ),
        Target(
            "share of parts on which it beats the hull",
            0.8,
            lambda own: own.share_below("hull"),
            at_least=True,
            is_of_cloud=True,
        ),
        Target(
            "share of parts worse than space carving by more than 5 %",
            0.05,
            lambda own: own.share_above("carve", CLEARLY_WORSE),
            is_of_cloud=True,
        ),
        Target(
            "EMD of the hull over its own, parts with pockets",
            1.7,
            _hull_over_own,
            at_least=True,
            is_of_cloud=True,
        ),
        _covered_target("0.5", 0.62),
        _covered_target("1", 0.85),
        *_nerf_targets(depth_mse=0.0004, coverage=0.993, memory_gb=1.5),
    ],
    "r2n2": _network_targets(0.065),
    "atlasnet": _network_targets(0.070),
    "occupancy": _network_targets(0.070),
}


@dataclass(frozen=True)
class SupplementaryValue:
    """The same mean in mm or mm^2."""

    value: float
    unit: str


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
    return [
        goal
        for method, targets in TARGETS.items()
        for target in targets
        if (goal := _goal(MethodResults(study, costs, method), target))
    ]


def _goal(own: MethodResults, target: Target) -> Goal | None:
    value = target.measure(own)
    if value is None:
        return None
    names = REFERENCE_METHODS if target.is_of_cloud else ()
    references = {name: target.measure(MethodResults(own.study, own.costs, name)) for name in names}
    in_mm = own.mean_in_mm(target.metric_key) if target.metric_key else None
    is_time = target.quantity in (MEAN_SECONDS, SLOW_SECONDS)
    kind = ("wall " if own.has_wall_time else "processor ") if is_time else ""
    return Goal(
        own.method,
        kind + target.quantity,
        target.bound,
        target.at_least,
        value,
        {name: known for name, known in references.items() if known is not None},
        SupplementaryValue(*in_mm) if in_mm else None,
        own.mean(DEPTH_COVERAGE) if target.metric_key == DEPTH_MSE else None,
    )


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
    """Such as `3.35 mm`, or `66.1 mm², coverage 0.991`."""
    if goal.supplement is None:
        return ""
    text = f"{format_significant(goal.supplement.value)} {goal.supplement.unit.replace('^2', '²')}"
    return text if goal.coverage is None else f"{text}, coverage {goal.coverage:.3f}"


def goals_md(goals: Sequence[Goal]) -> str:
    """`goals.md`: the table, or why there is none."""
    placeholder = "No method that has goals ran, or there is no test part.\n"
    return markdown_table(COLUMNS, map(format_row, goals)) if goals else placeholder
