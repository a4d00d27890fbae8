"""Few of many places, so that any number of them includes all smaller numbers."""

import numpy as np
from jaxtyping import Float, Int64


def nested_view_subset(
    positions: Float[np.ndarray, "n 3"], count: int
) -> Int64[np.ndarray, "count"]:
    """Indices of `count` of `places`, ascending: the first, and each next the farthest from all.

    Of places alike far the one with the lower index is taken.  `count` is at most n.
    """
    chosen = [0]
    distance = np.full(len(positions), np.inf)
    while len(chosen) < count:
        distance = np.minimum(distance, np.linalg.norm(positions - positions[chosen[-1]], axis=1))
        distance[chosen] = -1.0
        chosen.append(int(distance.argmax()))
    return np.sort(chosen)
