"""Paired significance tests between methods.

Each of TESTED_METHODS is compared with every other method on the EMD (even) of every test part,
failures included, by a paired permutation test that flips the signs of whole families. Nulls and
bounds are left out: a test against a reference would only make every other p-value larger. Each
network is compared with the methods that it must beat (`table1.MUST_BEAT`). These are two sets of
hypotheses, each with its own Holm correction.
"""

from collections.abc import Iterable
from dataclasses import astuple, dataclass, fields, replace
from statistics import fmean

from industnerf.artifacts.scores import Score
from industnerf.methods.base import Method, Role
from industnerf.report import paper_results
from industnerf.report.statistics.significance import (
    bootstrap_interval,
    holm_correction,
    sign_flip_p,
)
from industnerf.report.study import Study
from industnerf.report.tables.formats import (
    csv_text,
    format_interval,
    label_intervals,
    markdown_table,
)
from industnerf.report.tables.scores import EMD_EVEN, scores_of, select_scores
from industnerf.report.tables.table1 import MUST_BEAT
from industnerf.schema import ReportParams
from industnerf.seeds import generator

TESTED_METHODS = ("industnerf_plus", paper_results.METHOD)  # the best first
NO_COMPARISONS = (
    f"There is nothing to compare {' or '.join(TESTED_METHODS)} with, or no test part to do it on."
)


@dataclass(frozen=True)
class Comparison:
    """`method` against `other` over the test parts that both have a score on."""

    method: str
    other: str
    difference: float  # of the mean EMD: negative where `method` is better
    ci_low: float | None  # None: one family has no interval
    ci_high: float | None
    difference_mm: float  # of each part in mm, their mean
    p: float
    p_holm: float
    win_rate: float  # share of the parts on which `method` is better
    parts: int
    families: int


def compare_methods(study: Study, settings: ReportParams) -> list[Comparison]:
    """A comparison for every pair of both sets that has a test part in common."""
    hypothesis_sets = method_pairs(study.methods.values()), net_pairs(study)
    return [
        comparison
        for hypotheses in hypothesis_sets
        for comparison in _holm_corrected(study, settings, hypotheses)
    ]


def _holm_corrected(
    study: Study, settings: ReportParams, hypotheses: list[tuple[str, str]]
) -> list[Comparison]:
    results = [
        comparison
        for method, other in hypotheses
        if (comparison := _compare(study, settings, method, other))
    ]
    adjusted = holm_correction([comparison.p for comparison in results])
    return [replace(result, p_holm=p) for result, p in zip(results, adjusted, strict=True)]


def method_pairs(methods: Iterable[Method]) -> list[tuple[str, str]]:
    """Each of TESTED_METHODS with every other method but nulls and bounds, no pair twice."""
    names = [method.name for method in methods if method.role == Role.METHOD]
    tested = [name for name in TESTED_METHODS if name in names]
    return [
        (first, other)
        for i, first in enumerate(tested)
        for other in names
        if other not in tested[: i + 1]
    ]


def net_pairs(study: Study) -> list[tuple[str, str]]:
    """Each network with each of the methods that it must beat."""
    learned = [
        name
        for name in study.methods
        if (summary := study.training_summaries.get(name)) and summary.model_size
    ]
    return [(net, other) for net in learned for other in MUST_BEAT if other in study.methods]


def emd_even_by_part(study: Study, method: str) -> dict[str, Score]:
    """The EMD (even) of `method` on every test part."""
    scores = select_scores(scores_of(study, method, "test"), *EMD_EVEN)
    return {row.part_id: row.score for row in scores}


def _compare(study: Study, settings: ReportParams, method: str, other: str) -> Comparison | None:
    own_scores, other_scores = emd_even_by_part(study, method), emd_even_by_part(study, other)
    common = sorted(own_scores.keys() & other_scores.keys())
    if not common:
        return None
    differences = [own_scores[part].value - other_scores[part].value for part in common]
    families = [study.parts[part].family for part in common]
    low, high = bootstrap_interval(differences, families, settings, study.seed)
    p = sign_flip_p(differences, families, generator(study.seed, "sign flips"))
    wins = sum(difference < 0 for difference in differences) / len(differences)
    mean_mm = fmean(
        d * study.parts[part].diagonal_mm for part, d in zip(common, differences, strict=True)
    )
    mean, count = fmean(differences), len(set(families))
    return Comparison(method, other, mean, low, high, mean_mm, p, p, wins, len(common), count)


def comparisons_csv(comparisons: list[Comparison]) -> str:
    """`comparisons.csv`, one column a field of Comparison."""
    return csv_text([field.name for field in fields(Comparison)], map(astuple, comparisons))


COLUMNS = ("method", "against", "difference", "95 %", "mm", "p", "p (Holm)", "better on", "parts")


def comparisons_md(comparisons: list[Comparison], interval: float) -> str:
    """`comparisons.md`: the table, or why there is none."""
    if not comparisons:
        return f"{NO_COMPARISONS}\n"
    return markdown_table(label_intervals(COLUMNS, interval), map(format_row, comparisons))


def format_row(comparison: Comparison) -> list[str]:
    """`comparison` as text, one for each of COLUMNS."""
    return [
        comparison.method,
        comparison.other,
        f"{comparison.difference:+.4f}",
        format_interval(comparison.ci_low, comparison.ci_high, "+.4f"),
        f"{comparison.difference_mm:+.2f}",
        f"{comparison.p:.2g}",
        f"{comparison.p_holm:.2g}",
        f"{100 * comparison.win_rate:.0f} %",
        f"{comparison.parts} in {comparison.families} families",
    ]
