"""Few of many places, so that any number of them includes all smaller numbers."""

import numpy as np
from jaxtyping import Float, Int64


def nested(places: Float[np.ndarray, "n 3"], count: int) -> Int64[np.ndarray, "count"]:
    """Indices of `count` of `places`, ascending: the first, and each next the farthest from all.

    Of places alike far the one with the lower index is taken.  `count` is at most n.
    """
    chosen = [0]
    away = np.full(len(places), np.inf)
    while len(chosen) < count:
        away = np.minimum(away, np.linalg.norm(places - places[chosen[-1]], axis=1))
        away[chosen] = -1.0
        chosen.append(int(away.argmax()))
    return np.sort(chosen)
