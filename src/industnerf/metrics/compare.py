"""All metrics of protocol P1 between two sampled surfaces; bounding-box diagonal 1.

P1-even   both sides reduced by farthest points: geometry alone
P1-iid    the prediction reduced by random choice: geometry and density (paper, 4.3)
P1-full   as P1-even, but of the whole surface, hidden parts too
P1-dense  all samples of both sides
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from industnerf.metrics.emd import emd
from industnerf.metrics.nearest_distances import chamfer, fscore, nearest_distances
from industnerf.metrics.reference_rig import ReferenceSurface
from industnerf.metrics.subsample import random_points
from industnerf.metrics.surface_samples import SampledSurface
from industnerf.schema import EvaluateParams


@dataclass(frozen=True)
class MetricValue:
    """One metric under one protocol."""

    metric: str
    protocol: str
    value: float
    unit: str
    smaller_is_better: bool = True


def compare(
    reference: ReferenceSurface,
    truth: SampledSurface,
    predicted: SampledSurface,
    settings: EvaluateParams,
    rng: np.random.Generator,
) -> list[MetricValue]:
    """Every metric of `predicted` against `truth`, samples of the surface of `reference`.

    Raises MetricError if a distance cannot be computed exactly.
    """
    n = settings.points
    visible = compare_visible(reference, truth, predicted, settings)
    if truth.evaluated.all() and predicted.evaluated.all():
        full = next(
            value.value for value in visible if (value.metric, value.protocol) == ("emd", "P1-even")
        )
    else:
        full = emd(*(side.even_points(n, only_visible=False) for side in (truth, predicted))).value
    iid = emd(
        truth.even_points(n, only_visible=True), random_points(predicted.visible_points, n, rng)
    ).value
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
    """The deterministic metrics of the visible surface: geometry alone."""
    n = settings.points
    even = emd(*(side.even_points(n, only_visible=True) for side in (truth, predicted))).value
    return [
        MetricValue("emd", "P1-even", even, "diagonal"),
        *dense_metrics(reference, truth, predicted, settings),
    ]


def dense_metrics(
    reference: ReferenceSurface,
    truth: SampledSurface,
    predicted: SampledSurface,
    settings: EvaluateParams,
) -> list[MetricValue]:
    """The metrics of all samples of the visible surface: those without an assignment."""
    distances = nearest_distances(truth.visible_points, predicted.visible_points)
    return [
        MetricValue("chamfer", "P1-dense", chamfer(distances), "diagonal"),
        MetricValue(
            "fscore", "P1-dense", fscore(distances, settings.fscore_threshold), "share", False
        ),
        *deviation_metrics(
            reference,
            predicted.visible_points,
            distances.truth_to_predicted,
            settings.tolerances_mm,
        ),
    ]


HAUSDORFF_QUANTILE = 0.95  # of either side; the farthest 5 % may be anywhere


def deviation_metrics(
    reference: ReferenceSurface,
    predicted: Float[np.ndarray, "n 3"],
    truth_to_predicted: Float[np.ndarray, "m"],
    tolerances_mm: Sequence[float],
) -> list[MetricValue]:
    """Shares in tolerance (mm), and the Hausdorff distance at 95 %, of the points `predicted`.

    `predicted` and `truth_to_predicted` are in diagonals.  `within` a tolerance is the share of
    predicted points that are so near to the surface itself, `covered` the share of samples of the
    true surface that are so near to a predicted point.  Hausdorff-95 (mm)
    is the larger of the 95th percentiles of both distances.
    """
    # late: a stage that only names the metric need not wait for Warp
    from industnerf.geometry.surface_distance import distance_to_surface

    mesh, to_mm = reference.mesh, reference.diagonal_mm
    deviation_mm = (
        distance_to_surface(predicted, reference.normalize(mesh.vertices), mesh.faces) * to_mm
    )
    truth_to_predicted_mm = truth_to_predicted * to_mm
    hausdorff = max(
        float(np.quantile(side, HAUSDORFF_QUANTILE))
        for side in (deviation_mm, truth_to_predicted_mm)
    )
    shares = [
        MetricValue(
            f"{name}_{limit:g}mm", "P1-dense", float((side <= limit).mean()), "share", False
        )
        for name, side in (("within", deviation_mm), ("covered", truth_to_predicted_mm))
        for limit in tolerances_mm
    ]
    return [*shares, MetricValue("hausdorff95", "P1-dense", hausdorff, "mm")]
