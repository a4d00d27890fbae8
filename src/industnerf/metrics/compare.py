"""All metrics of protocol P1 between two sampled surfaces; bounding-box diagonal 1.

P1-even   both sides reduced by farthest points: geometry alone
P1-iid    the prediction reduced by random choice: geometry and density (paper, 4.3)
P1-full   as P1-even, but of the whole surface, hidden parts too
P1-dense  all samples of both sides
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from industnerf.metrics.chamfer import chamfer
from industnerf.metrics.emd import emd
from industnerf.metrics.fscore import fscore
from industnerf.metrics.metric_value import MetricValue
from industnerf.metrics.nearest_distances import nearest_distances
from industnerf.metrics.reference_rig import ReferenceSurface
from industnerf.metrics.subsample import farthest_points, random_points
from industnerf.metrics.surface_deviation import deviation_metrics
from industnerf.schema import EvaluateParams


@dataclass(frozen=True)
class SampledSurface:
    """Points in diagonals, and which of them count against the visible surface."""

    points: Float[np.ndarray, "n 3"]
    evaluated: Bool[np.ndarray, "n"]


def compare(
    reference: ReferenceSurface,
    truth: SampledSurface,
    predicted: SampledSurface,
    settings: EvaluateParams,
    rng: np.random.Generator,
) -> list[MetricValue]:
    """Every metric of `predicted` against `truth`, samples of the surface of `frame`.

    Raises MetricError if a distance cannot be computed exactly.
    """
    n = settings.points
    predicted_points = predicted.points[predicted.evaluated]
    visible = compare_visible(reference, truth, predicted, settings)
    if truth.evaluated.all() and predicted.evaluated.all():
        full = next(
            value.value for value in visible if (value.metric, value.protocol) == ("emd", "P1-even")
        )
    else:
        full = emd(farthest_points(truth.points, n), farthest_points(predicted.points, n))
    iid = emd(
        farthest_points(truth.points[truth.evaluated], n), random_points(predicted_points, n, rng)
    )
    return [
        *visible,
        MetricValue("emd", "P1-iid", iid, "diagonal"),
        MetricValue("emd", "P1-full", full, "diagonal"),
    ]


def compare_visible(
    reference: ReferenceSurface,
    truth: SampledSurface,
    predicted: SampledSurface,
    settings: EvaluateParams,
) -> list[MetricValue]:
    """The metrics of the visible surface that no chance enters into: geometry alone."""
    n = settings.points
    truth_points = truth.points[truth.evaluated]
    predicted_points = predicted.points[predicted.evaluated]
    even = emd(farthest_points(truth_points, n), farthest_points(predicted_points, n))
    distances = nearest_distances(truth_points, predicted_points)
    return [
        MetricValue("emd", "P1-even", even, "diagonal"),
        MetricValue("chamfer", "P1-dense", chamfer(distances), "diagonal"),
        MetricValue(
            "fscore", "P1-dense", fscore(distances, settings.fscore_threshold), "share", False
        ),
        *deviation_metrics(
            reference, predicted_points, distances.truth_to_predicted, settings.tolerances_mm
        ),
    ]
