"""What the suite set out to reach on the test parts, and what it reached.

The bounds were written down before the methods were: they are the design's, not results.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import fmean

from industnerf.artifacts.scores import Score
from industnerf.report.comparisons import even_by_part
from industnerf.report.costs import CostRow
from industnerf.report.formats import csv_text, markdown
from industnerf.report.gather import Study
from industnerf.report.lookup import only, scores_of

OURS, PLUS, HULL = "industnerf", "industnerf_plus", "hull"
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

    @property
    def met(self) -> bool:
        return self.value >= self.bound if self.at_least else self.value <= self.bound

    @property
    def wanted(self) -> str:
        return f"{'at least' if self.at_least else 'at most'} {self.bound:g}"


def goals(study: Study, costs: Sequence[CostRow]) -> list[Goal]:
    """All that the study has the methods, and the seconds, for."""
    one, plus = even_by_part(study, OURS), even_by_part(study, PLUS)
    hull = even_by_part(study, HULL)
    found = [
        _of_mean(OURS, "EMD (even)", 0.020, [s.value for s in one.values()]),
        _of_mean(
            OURS,
            f"EMD (even) in floors, parts that the rig sees to {WHOLE:g} without pockets",
            1.4,
            [s.value / s.floor for part, s in one.items() if _open(study, part)],
        ),
        _of_mean(PLUS, "EMD (even)", 0.0122, [s.value for s in plus.values()]),
        *_against_hull(study, plus, hull),
    ]
    for method in (OURS, PLUS):
        found += [*_pictures(study, method), *_confidence(study, method)]
        found += _cost(study, costs, method)
    return [goal for goal in found if goal]


def _of_mean(
    method: str, what: str, bound: float, values: list[float], *, at_least: bool = False
) -> Goal | None:
    return Goal(method, what, bound, at_least, fmean(values)) if values else None


def _open(study: Study, part: str) -> bool:
    """Whether the reference rig sees nearly all of it, and none of that is a pocket."""
    return study.seen_by_rig.get(part, 0.0) >= WHOLE and POCKETS not in study.parts[part].strata


def _against_hull(study: Study, plus: Found, hull: Found) -> list[Goal]:
    common = plus.keys() & hull.keys()
    if not common:
        return []
    wins = fmean(plus[part].value < hull[part].value for part in common)
    found = [Goal(PLUS, "share of parts on which it beats the hull", 0.8, True, wins)]
    deep = [part for part in common if POCKETS in study.parts[part].strata]
    if deep:
        theirs, ours = (fmean(scores[part].value for part in deep) for scores in (hull, plus))
        found.append(
            Goal(PLUS, "EMD of the hull over its own, parts with pockets", 3.0, True, theirs / ours)
        )
    return found


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
        ("method", "goal", "wanted", "value", "met"),
        [(g.method, g.what, g.wanted, g.value, "yes" if g.met else "no") for g in found],
    )


COLUMNS = ("method", "goal", "wanted", "measured", "met")


def cells(goal: Goal) -> list[str]:
    """`goal` as people read it, one text for each of COLUMNS."""
    measured = f"{goal.value:.3g}"
    return [goal.method, goal.what, goal.wanted, measured, "yes" if goal.met else "**no**"]


def goals_md(found: Sequence[Goal]) -> str:
    """`goals.md`: the table, or why there is none."""
    return markdown(COLUMNS, map(cells, found)) if found else "None of the methods ran.\n"
