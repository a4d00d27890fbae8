"""In millimeters, the language of inspection: how much is in tolerance, how bad the worst is."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from industnerf.metrics.metric_value import MetricValue
from industnerf.metrics.reference_rig import ReferenceSurface

HAUSDORFF_QUANTILE = (
    0.95  # of either side that the Hausdorff distance is taken of: the rest may be anything
)


def deviation_metrics(
    reference: ReferenceSurface,
    predicted: Float[np.ndarray, "n 3"],
    truth_to_predicted: Float[np.ndarray, "m"],
    tolerances_mm: Sequence[float],
) -> list[MetricValue]:
    """Shares in tolerance, and the Hausdorff distance at 95 %, of the points `shown`.

    `shown` and `missed` are in diagonals; `missed` is how far each sample of the true surface is
    from the nearest point.  `within` a tolerance is the share of points that are so near to the
    surface itself, `covered` the share of samples that are so near to a point.  Hausdorff-95 (mm)
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
