"""What goals are about: quantities of one method over the test parts."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean, quantiles

from industnerf.artifacts.scores import Score
from industnerf.report.statistics.comparisons import emd_even_by_part
from industnerf.report.study import Study
from industnerf.report.tables.costs import CostRow
from industnerf.report.tables.scores import (
    AUSE,
    AUSE_RANDOM,
    scores_of,
    select_scores,
    unit_in_mm,
    values_in_mm,
)
from industnerf.store import Cost

FULLY_VISIBLE = 0.98  # share of the surface seen by the reference rig that counts as all
POCKETS = "pockets"

MetricKey = tuple[str, str]  # metric and protocol


@dataclass(frozen=True)
class MethodResults:
    """One method of a study. Every quantity is None where what it is made of is not known."""

    study: Study
    costs: Sequence[CostRow]
    method: str

    def mean(self, key: MetricKey) -> float | None:
        """The mean of a metric."""
        rows = select_scores(scores_of(self.study, self.method, "test"), *key)
        return fmean(row.score.value for row in rows) if rows else None

    def mean_in_mm(self, key: MetricKey) -> tuple[float, str] | None:
        """The mean, each part in mm or mm^2, and that unit; None if the metric is no length."""
        rows = select_scores(scores_of(self.study, self.method, "test"), *key)
        unit = unit_in_mm(rows)
        return (fmean(values_in_mm(self.study, rows)), unit) if unit else None

    def fully_visible_floors(self) -> float | None:
        """EMD in floors of parts that the reference rig sees to FULLY_VISIBLE, without pockets."""
        ratios = [
            score.value / score.floor
            for part, score in self._emds().items()
            if self.study.rig_visible_share.get(part, 0.0) >= FULLY_VISIBLE
            and POCKETS not in self.study.parts[part].strata
        ]
        return fmean(ratios) if ratios else None

    def worst_floors(self) -> float | None:
        """EMD in floors of the worst part."""
        return max((score.value / score.floor for score in self._emds().values()), default=None)

    def share_below(self, other: str) -> float | None:
        """Share of the parts whose EMD is below that of `other`."""
        pairs = self._pairs_with(other)
        return fmean(own < reference for own, reference in pairs) if pairs else None

    def share_above(self, other: str, factor: float) -> float | None:
        """Share of the parts whose EMD is above `factor` times that of `other`."""
        pairs = self._pairs_with(other)
        return fmean(own > factor * reference for own, reference in pairs) if pairs else None

    def ratio_to(self, other: str, stratum: str = "") -> float | None:
        """Mean EMD over that of `other`, over the parts of `stratum`; empty: over all."""
        pairs = self._pairs_with(other, stratum)
        if not pairs:
            return None
        own, reference = zip(*pairs, strict=True)
        return fmean(own) / fmean(reference)

    def ause_share(self) -> float | None:
        """AUSE over that of a random order; of the means, not part by part."""
        area, random_area = self.mean(AUSE), self.mean(AUSE_RANDOM)
        return area / random_area if area is not None and random_area else None

    def mean_seconds(self) -> float | None:
        """Of a reconstruction."""
        seconds = [cost.processor_seconds for cost in self._costs()]
        return fmean(seconds) if seconds else None

    def slow_seconds(self) -> float | None:
        """What nine parts in ten stay below."""
        seconds = [cost.processor_seconds for cost in self._costs()]
        return quantiles(seconds, n=10, method="inclusive")[-1] if len(seconds) > 1 else None

    @property
    def has_wall_time(self) -> bool:
        """Whether seconds are by the clock: results are older than the record of processor time."""
        return any(cost.cpu_seconds is None for cost in self._costs())

    def peak_gb(self) -> float | None:
        """Peak memory of the part that needs most."""
        peaks = [cost.peak_mb * 2**20 / 1e9 for cost in self._costs()]  # peak_mb counts MiB
        return max(peaks, default=None)

    def _emds(self) -> dict[str, Score]:
        return emd_even_by_part(self.study, self.method)

    def _pairs_with(self, other: str, stratum: str = "") -> list[tuple[float, float]]:
        """EMD, and that of `other`, of the parts that have both."""
        own, reference = self._emds(), emd_even_by_part(self.study, other)
        return [
            (own[part].value, reference[part].value)
            for part in own.keys() & reference.keys()
            if not stratum or stratum in self.study.parts[part].strata
        ]

    def _costs(self) -> list[Cost]:
        """Of the test parts; a part of a published study may have a cost and no score."""
        assignments = self.study.assignments
        return [
            row.cost
            for row in self.costs
            if (row.stage, row.method) == ("reconstruct", self.method)
            and row.part_id in assignments
            and assignments[row.part_id].split == "test"
        ]
