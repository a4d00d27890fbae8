"""In millimetres, the language of inspection: how much is in tolerance, how bad the worst is."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from industnerf.metrics.values import Value
from industnerf.metrics.visible import Frame

SHARE = 0.95  # of either side that the Hausdorff distance is taken of: the rest may be anything


def inspected(
    frame: Frame,
    shown: Float[np.ndarray, "n 3"],
    missed: Float[np.ndarray, "m"],
    tolerances_mm: Sequence[float],
) -> list[Value]:
    """Shares in tolerance, and the Hausdorff distance at 95 %, of the points `shown`.

    `shown` and `missed` are in diagonals; `missed` is how far each sample of the true surface is
    from the nearest point.  `within` a tolerance is the share of points that are so near to the
    surface itself, `covered` the share of samples that are so near to a point.  Hausdorff-95 (mm)
    is the larger of the 95th percentiles of both distances.
    """
    # late: a stage that only names the metric need not wait for Warp
    from industnerf.geometry.closest import distance_to_surface

    mesh, to_mm = frame.mesh, frame.diagonal_mm
    away = distance_to_surface(shown, frame.unit(mesh.vertices), mesh.faces) * to_mm
    missed_mm = missed * to_mm
    worst = max(float(np.quantile(side, SHARE)) for side in (away, missed_mm))
    shares = [
        Value(f"{name}_{limit:g}mm", "P1-dense", float((side <= limit).mean()), "share", False)
        for name, side in (("within", away), ("covered", missed_mm))
        for limit in tolerances_mm
    ]
    return [*shares, Value("hausdorff95", "P1-dense", worst, "mm")]
