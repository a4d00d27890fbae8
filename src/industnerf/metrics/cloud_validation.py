"""Validation of the clouds that metrics compare."""

import numpy as np
from jaxtyping import Float64

from industnerf.errors import MetricError


def validate_cloud(cloud: np.ndarray, name: str) -> Float64[np.ndarray, "n 3"]:
    """`cloud` in float64; raises MetricError if it is empty, not (n, 3) or not finite."""
    if cloud.ndim != 2 or cloud.shape[1] != 3:
        raise MetricError(f"cloud {name!r} has shape {cloud.shape}; points must be (n, 3)")
    if len(cloud) == 0:
        raise MetricError(f"cloud {name!r} is empty; a distance to nothing is undefined")
    points = np.asarray(cloud, dtype=np.float64)
    bad_rows = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad_rows):
        raise MetricError(
            f"cloud {name!r} has {len(bad_rows)} of {len(points)} points that are not finite, "
            f"the first at row {bad_rows[0]}: {points[bad_rows[0]]}"
        )
    return points
