"""What the suite set out to reach on the test parts, what it reached, and what could be reached.

The bounds were written down before the methods were: they are the design's, not results.  Beside
each that is about clouds stands the same quantity of YARDSTICKS, of which one is given true depth
and one the answer: where a bound is beyond the oracle, no method can meet it.  Beside a mean length
stands the mean in mm, and beside mean seconds the share of the parts that take longer than wanted.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from statistics import fmean

from industnerf.artifacts.scores import PartScore, Score
from industnerf.report import paper
from industnerf.report.comparisons import even_by_part
from industnerf.report.costs import CostRow
from industnerf.report.formats import brief, csv_text, markdown
from industnerf.report.gather import Study
from industnerf.report.lookup import AUSE, CHANCE, EVEN, SPEARMAN, only, scores_of
from industnerf.report.millimetres import in_mm, unit_in_mm

PLUS, HULL = "industnerf_plus", "hull"
YARDSTICKS = ("tsdf", "oracle")
WHOLE = 0.98  # share of the surface that the reference rig sees, from which on it counts as all
POCKETS = "pockets"
MEAN_EMD = "EMD (even)"
WHOLE_EMD = f"EMD (even) in floors, parts that the rig sees to {WHOLE:g} without pockets"
ABOVE = "share of parts above"
AUSE_SHARE = "AUSE of confidence, over that of a random order (0: of the true order)"

Found = dict[str, Score]  # by part


@dataclass(frozen=True)
class Beside:
    """What a mean alone does not say."""

    value: float
    unit: str  # mm or mm^2: the same mean, parts in mm; or ABOVE: the parts beyond the bound


@dataclass(frozen=True)
class Goal:
    """One number that was to be at most, or at least, a bound."""

    method: str
    what: str
    bound: float
    at_least: bool
    value: float
    reached: dict[str, float] = field(default_factory=dict)  # the same by each yardstick that ran
    beside: Beside | None = None

    @property
    def met(self) -> bool:
        return self.value >= self.bound if self.at_least else self.value <= self.bound

    @property
    def wanted(self) -> str:
        return f"{'at least' if self.at_least else 'at most'} {self.bound:g}"


def goals(study: Study, costs: Sequence[CostRow]) -> list[Goal]:
    """All that the study has the methods, and the seconds, for."""
    found = [*_clouds(study)]
    for method in (paper.METHOD, PLUS):
        found += [*_pictures(study, method), *_confidence(study, method)]
        found += _cost(study, costs, method)
    return found


def _clouds(study: Study) -> Iterable[Goal]:
    """Of the EMD (even), and of what is made of it."""
    hull = even_by_part(study, HULL)
    asked: list[tuple[str, str, float, bool, Callable[[Found], float | None]]] = [
        (paper.METHOD, MEAN_EMD, 0.020, False, _mean),
        (paper.METHOD, WHOLE_EMD, 1.4, False, partial(_floors, study)),
        (PLUS, MEAN_EMD, 0.0122, False, _mean),
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
            even = only(scores_of(study, method, "test"), *EVEN)
            beside = _mean_in_mm(study, even) if what == MEAN_EMD else None
            yield Goal(method, what, bound, at_least, known.pop(method), known, beside)


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


def _mean_in_mm(study: Study, scores: Sequence[PartScore]) -> Beside | None:
    """None if `scores`, all of one metric, are of no length."""
    unit = unit_in_mm(scores)
    return Beside(fmean(in_mm(study, scores)), unit) if unit else None


def _pictures(study: Study, method: str) -> Iterable[Goal]:
    """Of the held-out views, over the union of true and rendered foreground."""
    bounds = {
        "rgb_mse": ("RGB MSE of held-out views", 0.004, False),
        "depth_mse": ("depth MSE of held-out views, diagonal 1", 0.0005, False),
        "coverage": ("share of the foreground that has a depth", 0.98, True),
    }
    scores = scores_of(study, method, "test")
    for metric, (what, bound, at_least) in bounds.items():
        if found := only(scores, metric, "P1-union"):
            value = fmean(row.score.value for row in found)
            yield Goal(method, what, bound, at_least, value, beside=_mean_in_mm(study, found))


def _confidence(study: Study, method: str) -> Iterable[Goal]:
    scores = scores_of(study, method, "test")
    means = {
        kind: fmean(row.score.value for row in found)
        for kind in (SPEARMAN, AUSE, CHANCE)
        if (found := only(scores, *kind))
    }
    if SPEARMAN in means:
        what = "rank correlation of confidence with the distance to the truth"
        yield Goal(method, what, -0.5, False, means[SPEARMAN])
    if means.get(CHANCE):
        yield Goal(method, AUSE_SHARE, 1.0, False, means[AUSE] / means[CHANCE])


def _cost(study: Study, costs: Sequence[CostRow], method: str) -> Iterable[Goal]:
    mine = [
        row.cost
        for row in costs
        if (row.stage, row.method) == ("reconstruct", method)
        and (place := study.places.get(row.part_id))  # of a published study it may have no score
        and place.split == "test"
    ]
    if not mine:
        return
    bound, seconds = 30.0, [cost.seconds for cost in mine]
    above = Beside(fmean(each > bound for each in seconds), ABOVE)
    what = "mean seconds a part, one core"
    yield Goal(method, what, bound, False, fmean(seconds), beside=above)
    most = max(cost.peak_mb for cost in mine) * 2**20 / 1e9  # peak_mb counts MiB
    yield Goal(method, "peak memory of any part, GB", 2.0, False, most)


def with_the_rigs(made: Sequence[Goal], published: Sequence[Mapping[str, str]]) -> list[Goal]:
    """`made` of scores, and in its place what no score tells: the goal about what the rig sees.

    `published` are the rows of a `goals.csv` of the same methods.
    """
    found = list(made)
    for at, row in enumerate(published):
        if row["goal"] == WHOLE_EMD:
            found.insert(at, _read(row))
    return found


def _read(row: Mapping[str, str]) -> Goal:
    side, bound = row["wanted"].rsplit(" ", 1)
    # an older file has no column of them
    reached = {name: float(row[name]) for name in YARDSTICKS if row.get(name)}
    value, at_least = float(row["value"]), side == "at least"
    return Goal(row["method"], row["goal"], float(bound), at_least, value, reached)


def goals_csv(found: Sequence[Goal]) -> str:
    """`goals.csv`."""
    return csv_text(
        ("method", "goal", "wanted", "value", "met", "beside", "unit", *YARDSTICKS),
        [
            (
                *(goal.method, goal.what, goal.wanted, goal.value, "yes" if goal.met else "no"),
                *((goal.beside.value, goal.beside.unit) if goal.beside else ("", "")),
                *(goal.reached.get(name) for name in YARDSTICKS),
            )
            for goal in found
        ],
    )


COLUMNS = ("method", "goal", "wanted", "measured", "met", "beside it", *YARDSTICKS)


def cells(goal: Goal) -> list[str]:
    """`goal` as people read it, one text for each of COLUMNS."""
    reached = [f"{goal.reached[name]:.3g}" if name in goal.reached else "" for name in YARDSTICKS]
    met = "yes" if goal.met else "**no**"
    return [goal.method, goal.what, goal.wanted, f"{goal.value:.3g}", met, _beside(goal), *reached]


def _beside(goal: Goal) -> str:
    """Such as `3.35 mm`, or `29 % of parts above 30`."""
    if goal.beside is None:
        return ""
    if goal.beside.unit == ABOVE:
        return f"{100 * goal.beside.value:.0f} % of parts above {goal.bound:g}"
    return f"{brief(goal.beside.value)} {goal.beside.unit.replace('^2', '²')}"


def goals_md(found: Sequence[Goal]) -> str:
    """`goals.md`: the table, or why there is none."""
    none = "No method that has goals ran, or there is no test part.\n"
    return markdown(COLUMNS, map(cells, found)) if found else none
