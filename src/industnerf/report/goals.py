"""What the suite set out to reach on the test parts, what it reached, and what could be reached.

The bounds were written down before the methods were: they are the design's, not results.  Beside
each that is about clouds stands the same quantity of YARDSTICKS, of which one is given true depth
and one the answer: where a bound is beyond the oracle, no method can meet it.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from statistics import fmean

from industnerf.artifacts.scores import Score
from industnerf.report.comparisons import even_by_part
from industnerf.report.costs import CostRow
from industnerf.report.formats import csv_text, markdown
from industnerf.report.gather import Study
from industnerf.report.lookup import only, scores_of

OURS, PLUS, HULL = "industnerf", "industnerf_plus", "hull"
YARDSTICKS = ("tsdf", "oracle")
WHOLE = 0.98  # share of the surface that the reference rig sees, from which on it counts as all
POCKETS = "pockets"

Found = dict[str, Score]  # by part


@dataclass(frozen=True)
class Goal:
    """One number that was to be at most, or at least, a bound."""

    method: str
    what: str
    bound: float
    at_least: bool
    value: float
    reached: dict[str, float] = field(default_factory=dict)  # the same by each yardstick that ran

    @property
    def met(self) -> bool:
        return self.value >= self.bound if self.at_least else self.value <= self.bound

    @property
    def wanted(self) -> str:
        return f"{'at least' if self.at_least else 'at most'} {self.bound:g}"


def goals(study: Study, costs: Sequence[CostRow]) -> list[Goal]:
    """All that the study has the methods, and the seconds, for."""
    found = [*_clouds(study)]
    for method in (OURS, PLUS):
        found += [*_pictures(study, method), *_confidence(study, method)]
        found += _cost(study, costs, method)
    return [goal for goal in found if goal]


def _clouds(study: Study) -> Iterable[Goal]:
    """Of the EMD (even), and of what is made of it."""
    hull = even_by_part(study, HULL)
    whole = f"EMD (even) in floors, parts that the rig sees to {WHOLE:g} without pockets"
    asked: list[tuple[str, str, float, bool, Callable[[Found], float | None]]] = [
        (OURS, "EMD (even)", 0.020, False, _mean),
        (OURS, whole, 1.4, False, partial(_floors, study)),
        (PLUS, "EMD (even)", 0.0122, False, _mean),
        (PLUS, "share of parts on which it beats the hull", 0.8, True, partial(_wins, hull)),
        (
            PLUS,
            "EMD of the hull over its own, parts with pockets",
            3.0,
            True,
            partial(_pockets, study, hull),
        ),
    ]
    for method, what, bound, at_least, measure in asked:
        names = (method, *YARDSTICKS)
        values = {name: measure(even_by_part(study, name)) for name in names}
        known = {name: value for name, value in values.items() if value is not None}
        if method in known:
            yield Goal(method, what, bound, at_least, known.pop(method), known)


def _mean(found: Found) -> float | None:
    return fmean(score.value for score in found.values()) if found else None


def _floors(study: Study, found: Found) -> float | None:
    """Over parts of which the reference rig sees nearly all, none of it a pocket."""
    ratios = [
        score.value / score.floor
        for part, score in found.items()
        if study.seen_by_rig.get(part, 0.0) >= WHOLE and POCKETS not in study.parts[part].strata
    ]
    return fmean(ratios) if ratios else None


def _wins(hull: Found, found: Found) -> float | None:
    common = found.keys() & hull.keys()
    return fmean(found[part].value < hull[part].value for part in common) if common else None


def _pockets(study: Study, hull: Found, found: Found) -> float | None:
    deep = [part for part in found.keys() & hull.keys() if POCKETS in study.parts[part].strata]
    if not deep:
        return None
    return fmean(hull[part].value for part in deep) / fmean(found[part].value for part in deep)


def _of_mean(
    method: str, what: str, bound: float, values: list[float], *, at_least: bool = False
) -> Goal | None:
    return Goal(method, what, bound, at_least, fmean(values)) if values else None


def _pictures(study: Study, method: str) -> Iterable[Goal | None]:
    """Of the held-out views, over the union of true and rendered foreground."""
    bounds = {
        "rgb_mse": ("RGB MSE of held-out views", 0.004, False),
        "depth_mse": ("depth MSE of held-out views, diagonal 1", 0.0005, False),
        "coverage": ("share of the foreground that has a depth", 0.98, True),
    }
    scores = scores_of(study, method, "test")
    for metric, (what, bound, at_least) in bounds.items():
        values = [row.score.value for row in only(scores, metric, "P1-union")]
        yield _of_mean(method, what, bound, values, at_least=at_least)


def _confidence(study: Study, method: str) -> Iterable[Goal | None]:
    scores = only(scores_of(study, method, "test"), "confidence_spearman", "P1-near")
    what = "rank correlation of confidence with the distance to the truth"
    yield _of_mean(method, what, -0.5, [row.score.value for row in scores])


def _cost(study: Study, costs: Sequence[CostRow], method: str) -> Iterable[Goal | None]:
    mine = [
        row.cost
        for row in costs
        if (row.stage, row.method) == ("reconstruct", method)
        and study.places[row.part_id].split == "test"
    ]
    yield _of_mean(method, "seconds a part, one core", 30.0, [cost.seconds for cost in mine])
    if mine:
        most = max(cost.peak_mb for cost in mine) * 2**20 / 1e9  # peak_mb counts MiB
        yield Goal(method, "peak memory of any part, GB", 2.0, False, most)


def goals_csv(found: Sequence[Goal]) -> str:
    """`goals.csv`."""
    return csv_text(
        ("method", "goal", "wanted", "value", "met", *YARDSTICKS),
        [
            (
                *(goal.method, goal.what, goal.wanted, goal.value, "yes" if goal.met else "no"),
                *(goal.reached.get(name) for name in YARDSTICKS),
            )
            for goal in found
        ],
    )


COLUMNS = ("method", "goal", "wanted", "measured", "met", *YARDSTICKS)


def cells(goal: Goal) -> list[str]:
    """`goal` as people read it, one text for each of COLUMNS."""
    beside = [f"{goal.reached[name]:.3g}" if name in goal.reached else "" for name in YARDSTICKS]
    met = "yes" if goal.met else "**no**"
    return [goal.method, goal.what, goal.wanted, f"{goal.value:.3g}", met, *beside]


def goals_md(found: Sequence[Goal]) -> str:
    """`goals.md`: the table, or why there is none."""
    return markdown(COLUMNS, map(cells, found)) if found else "None of the methods ran.\n"
