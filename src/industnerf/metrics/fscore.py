"""Shares of points that lie near the other cloud."""

import math

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from industnerf.errors import MetricError
from industnerf.metrics.clouds import checked


def share_within(
    a: Float[np.ndarray, "n 3"], b: Float[np.ndarray, "m 3"], distance: float
) -> float:
    """Share of the points of `a` no farther than `distance` from some point of `b`."""
    if not (math.isfinite(distance) and distance > 0):
        raise MetricError(f"a share within {distance!r} is undefined; it takes a positive length")
    near, _ = cKDTree(checked(b, "b")).query(
        checked(a, "a"), distance_upper_bound=np.nextafter(distance, np.inf)
    )  # bounded, for the search for a far neighbour is the slow one; exclusive, hence nextafter
    return float((near <= distance).mean())


def fscore(
    truth: Float[np.ndarray, "n 3"], predicted: Float[np.ndarray, "m 3"], distance: float
) -> float:
    """Harmonic mean of precision and recall at `distance`; 0 where both are.

    Precision is the share of `predicted` near `truth`, recall that of `truth` near `predicted`
    -- Knapitsch et al. (2017), Tanks and Temples, eq. 5 to 8.
    """
    precision = share_within(predicted, truth, distance)
    recall = share_within(truth, predicted, distance)
    return 2 * precision * recall / (precision + recall) if precision + recall else 0.0
