"""Validation of the clouds that metrics compare."""

import numpy as np
from jaxtyping import Float64

from industnerf.errors import MetricError


def validate_cloud(cloud: object, name: str) -> Float64[np.ndarray, "n 3"]:
    """`cloud`, an array or what numpy makes one of, in float64.

    Raises MetricError if it is empty, not (n, 3), not of real numbers or not finite.
    """
    try:
        cloud = np.asarray(cloud)
    except ValueError as error:  # rows of different lengths
        raise MetricError(f"cloud {name!r} is no array of points (n, 3): {error}") from None
    if cloud.dtype.kind not in "biuf":
        raise MetricError(f"cloud {name!r} is of {cloud.dtype}; coordinates must be real numbers")
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
