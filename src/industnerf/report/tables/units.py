"""Scores in units of the diagonal, in mm: part by part, for parts are of very different sizes."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from industnerf.artifacts.scores import PartScore
from industnerf.report.statistics.significance import bootstrap_interval
from industnerf.report.study import Study
from industnerf.schema import ReportParams

DIAGONAL_POWERS = {"diagonal": 1, "diagonal^2": 2}  # of the diagonal, that a unit is


@dataclass(frozen=True)
class MeanInMm:
    """A mean over parts, and its interval."""

    unit: str  # mm, or mm^2
    mean: float
    ci_low: float
    ci_high: float


def mean_in_mm(
    study: Study, settings: ReportParams, scores: Sequence[PartScore]
) -> MeanInMm | None:
    """The mean of `scores`, all of one metric; None if it is no length."""
    unit = unit_in_mm(scores)
    if unit is None:
        return None
    values = values_in_mm(study, scores)
    families = [study.parts[row.part_id].family for row in scores]
    interval = bootstrap_interval(values, families, settings, study.seed)
    return MeanInMm(unit, fmean(values), *interval)


def unit_in_mm(scores: Sequence[PartScore]) -> str | None:
    """mm, or mm^2: of `scores`, all of one metric; None if it is no length."""
    unit = scores[0].score.unit
    return unit.replace("diagonal", "mm") if unit in DIAGONAL_POWERS else None


def values_in_mm(study: Study, scores: Sequence[PartScore]) -> list[float]:
    """The values of `scores`, lengths all of one metric, in mm or mm^2."""
    power = DIAGONAL_POWERS[scores[0].score.unit]
    return [row.score.value * study.parts[row.part_id].diagonal_mm ** power for row in scores]
