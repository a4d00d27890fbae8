"""Scores of a study: look-up, selection, conversion to mm, `scores.csv`."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from statistics import fmean

from industnerf.artifacts.scores import PartScore, Score
from industnerf.report.statistics.significance import bootstrap_interval
from industnerf.report.study import Study
from industnerf.report.tables.formats import csv_text
from industnerf.schema import ReportParams

EMD_EVEN = ("emd", "P1-even")
DEPTH_COVERAGE = ("coverage", "P1-union")  # beside every error of depth
SPEARMAN = ("confidence_spearman", "P1-near")
AUSE, AUSE_RANDOM = ("confidence_ause", "P1-near"), ("confidence_ause_chance", "P1-near")


@dataclass(frozen=True)
class Scores:
    """All scores of a study."""

    by_key: dict[tuple[str, str, str, str], Score]

    @staticmethod
    def from_study(study: Study) -> "Scores":
        """The scores of `study`."""
        return Scores(
            {
                (row.part_id, row.method, row.score.metric, row.score.protocol): row.score
                for row in study.scores
            }
        )

    def get(
        self, part_id: str, method: str, metric_key: tuple[str, str] = EMD_EVEN
    ) -> Score | None:
        """The score under `metric_key`, a metric and its protocol; None if there is none."""
        return self.by_key.get((part_id, method, *metric_key))

    @cached_property
    def units_by_metric_key(self) -> dict[tuple[str, str], str]:
        """The unit of every metric and protocol, in the order of measurement.

        Looked for once: every part's section asks, and all scores of all parts have one.
        """
        return {key[2:]: score.unit for key, score in self.by_key.items()}


def scores_of(study: Study, method: str, split: str) -> list[PartScore]:
    """The scores of `method` on the parts of `split`."""
    return [
        row
        for row in study.scores
        if row.method == method and study.assignments[row.part_id].split == split
    ]


def select_scores(scores: list[PartScore], metric: str, protocol: str) -> list[PartScore]:
    """Those of `scores` that are of one metric under one protocol."""
    return [row for row in scores if (row.score.metric, row.score.protocol) == (metric, protocol)]


DIAGONAL_POWERS = {"diagonal": 1, "diagonal^2": 2}  # unit: power of the diagonal


@dataclass(frozen=True)
class MeanInMm:
    """A mean over parts, and its interval."""

    unit: str  # mm, or mm^2
    mean: float
    ci_low: float | None  # None: one family has no interval
    ci_high: float | None


def mean_in_mm(
    study: Study, settings: ReportParams, scores: Sequence[PartScore]
) -> MeanInMm | None:
    """The mean of `scores`, all of one metric, each part in mm; None if they are no lengths."""
    unit = unit_in_mm(scores)
    if unit is None:
        return None
    values = values_in_mm(study, scores)
    families = [study.parts[row.part_id].family for row in scores]
    interval = bootstrap_interval(values, families, settings, study.seed)
    return MeanInMm(unit, fmean(values), *interval)


def unit_in_mm(scores: Sequence[PartScore]) -> str | None:
    """mm or mm^2 for `scores`, all of one metric; None if they are no lengths."""
    unit = scores[0].score.unit
    return unit.replace("diagonal", "mm") if unit in DIAGONAL_POWERS else None


def values_in_mm(study: Study, scores: Sequence[PartScore]) -> list[float]:
    """The values of `scores`, lengths of one metric, in mm or mm^2."""
    power = DIAGONAL_POWERS[scores[0].score.unit]
    return [row.score.value * study.parts[row.part_id].diagonal_mm ** power for row in scores]


SCORE_COLUMNS = (
    *("part_id", "family", "method", "scope", "split", "preset", "seed", "metric", "protocol"),
    *("value", "floor", "floor_se", "unit", "status"),
)


def scores_csv(study: Study) -> str:
    """`scores.csv`: every score with its family, split, preset and seed."""
    return csv_text(SCORE_COLUMNS, [_score_row(study, row) for row in study.scores])


def _score_row(study: Study, row: PartScore) -> list[object]:
    score = row.score
    return [
        row.part_id,
        study.parts[row.part_id].family,
        row.method,
        study.methods[row.method].scope.value,
        study.assignments[row.part_id].split,
        study.preset,
        study.seed,
        score.metric,
        score.protocol,
        _lossless_text(score.value),
        _lossless_text(score.floor),
        "" if score.floor_se is None else _lossless_text(score.floor_se),
        score.unit,
        score.status,
    ]


def _lossless_text(value: float) -> str:
    """All digits: small differences of scores need them."""
    return repr(float(value)).removesuffix(".0")
