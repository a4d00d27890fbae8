"""The floors of a part: what a perfect method scores, in the mean over many samples of the truth.

A pair is the scored samples and an independent second draw.  More pairs are drawn until the
standard error is below 1 %, or up to a cap; the error that was reached stands beside the floor.

The EMD of randomly chosen points (P1-iid) varies by 5 to 20 % from draw to draw, and its mean would
take hundreds of solutions.  What varies is how many points fall on each region: a coarse EMD of the
counts in 256 cells follows it with a correlation of 0.95 to 0.999, in 1 % of the time.  So the mean
is that of the coarse EMD over many draws, plus that of the difference over few -- two-level Monte
Carlo, Giles (2008), Multilevel Monte Carlo path simulation, section 2.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from functools import cache, lru_cache
from itertools import count
from statistics import fmean

import numpy as np
from jaxtyping import Float, Int64
from scipy.spatial import cKDTree

from industnerf.artifacts.truth import FLOOR_ERROR, Floor
from industnerf.errors import MetricError
from industnerf.metrics.cells import WeightedCloud, kd_cells
from industnerf.metrics.compare import MetricValue, dense_metrics
from industnerf.metrics.emd import emd, weighted_emd
from industnerf.metrics.reference_rig import ReferenceSurface
from industnerf.metrics.subsample import farthest_points
from industnerf.metrics.surface_samples import SampledSurface, sample_reference
from industnerf.schema import EvaluateParams

MIN_PAIRS, MAX_PAIRS = 6, 64  # fewer tell no error
COARSE_BATCH, MAX_COARSE = 32, 2048  # draws at a time, and at most
MAX_CELLS = 256  # of the coarse EMD

Points = Float[np.ndarray, "n 3"]


def measure_floors(
    name: str,
    reference: ReferenceSurface,
    truth: SampledSurface,
    settings: EvaluateParams,
    seed: int,
) -> dict[str, Floor]:
    """Metric and protocol -> floor of the part `name`, whose scored samples are `truth`.

    Raises MetricError if the rig sees too few samples, or a distance cannot be computed exactly.
    """
    n = settings.points
    _require_enough(truth, settings)
    truth_visible, truth_full = (
        farthest_points(points, n) for points in (truth.visible_points, truth.points)
    )

    @lru_cache(MAX_PAIRS)  # 2 MB each; all metrics use the first ones, the coarse EMD more
    def sample_truth(k: int) -> SampledSurface:
        use = f"floor {k}" if k else "floor"
        drawn = sample_reference(name, reference, settings, seed, use)[1]
        _require_enough(drawn, settings)
        return drawn

    @cache
    def even(k: int) -> list[MetricValue]:
        value = emd(truth_visible, farthest_points(sample_truth(k).visible_points, n)).value
        return [MetricValue("emd", "P1-even", value, "diagonal")]

    def full(k: int) -> list[MetricValue]:
        if truth.evaluated.all() and sample_truth(k).evaluated.all():
            value = even(k)[0].value
        else:
            value = emd(truth_full, farthest_points(sample_truth(k).points, n)).value
        return [MetricValue("emd", "P1-full", value, "diagonal")]

    return {
        **_mean_floors(even),
        **_mean_floors(lambda k: dense_metrics(reference, truth, sample_truth(k), settings)),
        **_mean_floors(full),
        "emd P1-iid": iid_floor(
            truth_visible, (points for k in count() for points in _disjoint(sample_truth(k), n))
        ),
    }


def _require_enough(samples: SampledSurface, settings: EvaluateParams) -> None:
    num_visible = samples.evaluated.sum()
    if num_visible < settings.points:
        raise MetricError(
            f"the reference rig sees only {num_visible} of {settings.dense_samples} samples, fewer "
            f"than evaluate.points = {settings.points}; raise evaluate.dense_samples"
        )


def _disjoint(samples: SampledSurface, n: int) -> Iterator[Points]:
    """Independent draws of `n` random visible points each: the samples are in random order."""
    points = samples.visible_points
    for start in range(0, len(points) - n + 1, n):
        yield points[start : start + n]


def _mean_floors(measure: Callable[[int], list[MetricValue]]) -> dict[str, Floor]:
    """The mean of each value of `measure(0)`, `measure(1)`, ... when all of them are precise."""
    pairs: list[list[MetricValue]] = []
    while True:
        pairs.append(measure(len(pairs)))
        by_metric = list(zip(*pairs, strict=True))
        floors = [mean_floor([value.value for value in values]) for values in by_metric]
        is_precise = all(
            floor.standard_error
            <= (FLOOR_ERROR if values[0].unit == "share" else FLOOR_ERROR * floor.value)
            for floor, values in zip(floors, by_metric, strict=True)
        )
        if is_precise or len(pairs) == MAX_PAIRS:
            names = (f"{value.metric} {value.protocol}" for value in pairs[0])
            return dict(zip(names, floors, strict=True))


def iid_floor(truth: Points, draws: Iterator[Points]) -> Floor:
    """The mean EMD between `truth` and random `draws` of as many points, each used once."""
    cells = CoarseCells(truth)
    differences: list[float] = []
    coarse: list[float] = []
    while True:
        difference_mean, coarse_mean = mean_floor(differences), mean_floor(coarse)
        floor = Floor(
            difference_mean.value + coarse_mean.value,
            math.hypot(difference_mean.standard_error, coarse_mean.standard_error),
        )
        if floor.standard_error <= FLOOR_ERROR * floor.value:
            return floor
        needs_pair = difference_mean.standard_error > coarse_mean.standard_error
        if len(differences) < MIN_PAIRS or (needs_pair and len(differences) < MAX_PAIRS):
            points = next(draws)
            differences.append(emd(truth, points).value - cells.emd(points))
        elif len(coarse) < MAX_COARSE:
            coarse += [cells.emd(next(draws)) for _ in range(COARSE_BATCH)]
        else:
            return floor


class CoarseCells:
    """The EMD between clouds of the same number of points, each point moved to the next center."""

    def __init__(self, truth: Points) -> None:
        cells = WeightedCloud(truth, np.ones(len(truth)))
        while len(cells.points) > MAX_CELLS:
            cells = kd_cells(cells).coarse
        self._centers, self._tree = cells.points, cKDTree(cells.points)
        self._truth_counts = self._count(truth)

    def _count(self, points: Points) -> Int64[np.ndarray, "cells"]:
        return np.bincount(self._tree.query(points)[1], minlength=len(self._centers))

    def emd(self, points: Points) -> float:
        """That between `points` and the truth."""
        excess = (self._count(points) - self._truth_counts).astype(np.float64)
        if not excess.any():
            return 0.0
        source, target = (
            WeightedCloud(self._centers[sign * excess > 0], np.abs(excess[sign * excess > 0]))
            for sign in (1, -1)
        )
        return weighted_emd(source, target) * source.mass.sum() / len(points)


def mean_floor(values: Sequence[float]) -> Floor:
    """Their mean and its standard error, which is infinite for fewer than MIN_PAIRS values."""
    is_enough = len(values) >= MIN_PAIRS
    error = float(np.std(values, ddof=1)) / math.sqrt(len(values)) if is_enough else math.inf
    return Floor(fmean(values) if values else 0.0, error)
