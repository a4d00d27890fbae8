"""Is the paper's method, or the best that we have, better than what stands beside it?

Each of TESTED is compared with every other method on the EMD (even) of every test part, failures
included, by a paired permutation test that flips the signs of whole families.  With nulls and
bounds they are not compared: these are shown no picture, or the answer, so they are yardsticks,
and a test against one would only make every other p-value larger.  Each net is compared with what
it must beat to deserve its name, one of them a null (report/table1.py).  To Holm's correction these
two questions are a set of hypotheses each.
"""

from collections.abc import Iterable
from dataclasses import astuple, dataclass, fields, replace
from statistics import fmean

from industnerf.artifacts.scores import Score
from industnerf.methods.base import Method, Role
from industnerf.report import paper
from industnerf.report.formats import csv_text, interval_text, intervals_of, markdown
from industnerf.report.gather import Study
from industnerf.report.lookup import EVEN, only, scores_of
from industnerf.report.statistics import bootstrap_interval, holm, sign_flip_p
from industnerf.report.table1 import MUST_BEAT
from industnerf.schema import ReportParams
from industnerf.seeds import generator

TESTED = ("industnerf_plus", paper.METHOD)  # the best first
LEFT_OUT = f"There is nothing to compare {' or '.join(TESTED)} with, or no test part to do it on."


@dataclass(frozen=True)
class Comparison:
    """`method` against `other` over the test parts that both have a score on."""

    method: str
    other: str
    difference: float  # of the mean EMD: negative where `method` is better
    ci_low: float
    ci_high: float
    difference_mm: float  # of each part in mm, their mean
    p: float
    p_holm: float
    win_rate: float  # share of the parts on which `method` is better
    parts: int
    families: int


def comparisons(study: Study, settings: ReportParams) -> list[Comparison]:
    """A comparison for each of `pairs` and of `nets` that has a test part in common."""
    asked = pairs(study.methods.values()), nets(study)
    return [each for question in asked for each in _corrected(study, settings, question)]


def _corrected(
    study: Study, settings: ReportParams, question: list[tuple[str, str]]
) -> list[Comparison]:
    found = [
        comparison
        for one, other in question
        if (comparison := _compare(study, settings, one, other))
    ]
    raised = holm([comparison.p for comparison in found])
    return [replace(each, p_holm=p) for each, p in zip(found, raised, strict=True)]


def pairs(methods: Iterable[Method]) -> list[tuple[str, str]]:
    """Each of TESTED with every other method that is neither a null nor a bound, no pair twice."""
    names = [method.name for method in methods if method.role == Role.METHOD]
    ours = [name for name in TESTED if name in names]
    return [
        (one, other) for i, one in enumerate(ours) for other in names if other not in ours[: i + 1]
    ]


def nets(study: Study) -> list[tuple[str, str]]:
    """Each net with each of what it must beat."""
    learned = [name for name in study.methods if (it := study.lessons.get(name)) and it.size]
    return [(net, other) for net in learned for other in MUST_BEAT if other in study.methods]


def even_by_part(study: Study, method: str) -> dict[str, Score]:
    """The EMD (even) of `method` on every test part."""
    scores = only(scores_of(study, method, "test"), *EVEN)
    return {row.part_id: row.score for row in scores}


def _compare(study: Study, settings: ReportParams, one: str, other: str) -> Comparison | None:
    ours, theirs = even_by_part(study, one), even_by_part(study, other)
    common = sorted(ours.keys() & theirs.keys())
    if not common:
        return None
    differences = [ours[part].value - theirs[part].value for part in common]
    families = [study.parts[part].family for part in common]
    low, high = bootstrap_interval(differences, families, settings, study.seed)
    p = sign_flip_p(differences, families, generator(study.seed, "sign flips"))
    wins = sum(difference < 0 for difference in differences) / len(differences)
    mm = fmean(
        d * study.parts[part].diagonal_mm for part, d in zip(common, differences, strict=True)
    )
    mean, count = fmean(differences), len(set(families))
    return Comparison(one, other, mean, low, high, mm, p, p, wins, len(common), count)


def comparisons_csv(found: list[Comparison]) -> str:
    """`comparisons.csv`, one column a field of Comparison."""
    return csv_text([field.name for field in fields(Comparison)], map(astuple, found))


COLUMNS = ("method", "against", "difference", "95 %", "mm", "p", "p (Holm)", "better on", "parts")


def comparisons_md(found: list[Comparison], interval: float) -> str:
    """`comparisons.md`: the table, or why there is none."""
    if not found:
        return f"{LEFT_OUT}\n"
    return markdown(intervals_of(COLUMNS, interval), map(cells, found))


def cells(each: Comparison) -> list[str]:
    """`each` as people read it, one text for each of COLUMNS."""
    return [
        each.method,
        each.other,
        f"{each.difference:+.4f}",
        interval_text(each.ci_low, each.ci_high, each.families, "+.4f"),
        f"{each.difference_mm:+.2f}",
        f"{each.p:.2g}",
        f"{each.p_holm:.2g}",
        f"{100 * each.win_rate:.0f} %",
        f"{each.parts} in {each.families} families",
    ]
