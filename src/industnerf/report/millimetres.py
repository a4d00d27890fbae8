"""Scores in units of the diagonal, in mm: part by part, for parts are of very different sizes."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from industnerf.artifacts.scores import PartScore
from industnerf.report.gather import Study
from industnerf.report.statistics import bootstrap_interval
from industnerf.schema import ReportParams

POWERS = {"diagonal": 1, "diagonal^2": 2}  # of the diagonal, that a unit is


@dataclass(frozen=True)
class InMm:
    """A mean over parts, and its interval."""

    unit: str  # mm, or mm^2
    mean: float
    ci_low: float
    ci_high: float


def mean_in_mm(study: Study, settings: ReportParams, scores: Sequence[PartScore]) -> InMm | None:
    """The mean of `scores`, all of one metric; None if it is no length."""
    unit = scores[0].score.unit
    if unit not in POWERS:
        return None
    parts = [study.parts[row.part_id] for row in scores]
    lengths = [part.diagonal_mm ** POWERS[unit] for part in parts]
    values = [row.score.value * length for row, length in zip(scores, lengths, strict=True)]
    families = [part.family for part in parts]
    ends = bootstrap_interval(values, families, settings, study.seed)
    return InMm(unit.replace("diagonal", "mm"), fmean(values), *ends)
