"""Chamfer distance, of first order: distances are not squared."""

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from industnerf.metrics.clouds import checked


def nearest(a: Float[np.ndarray, "n 3"], b: Float[np.ndarray, "m 3"]) -> Float[np.ndarray, "n"]:
    """Distance of each point of `a` to the nearest of `b`."""
    left, right = checked(a, "a"), checked(b, "b")
    return cKDTree(right).query(left)[0]


def chamfer(a: Float[np.ndarray, "n 3"], b: Float[np.ndarray, "m 3"]) -> float:
    """Mean of the two directed mean distances, in the clouds' unit.

    (mean_i min_j |a_i - b_j| + mean_j min_i |a_i - b_j|) / 2 -- half of what those report who
    add the two, and no square.
    """
    return float((nearest(a, b).mean() + nearest(b, a).mean()) / 2)
