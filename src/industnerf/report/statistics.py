"""Means over parts, and how sure they are: parts of one family are not independent."""

from collections.abc import Sequence

import numpy as np


def bootstrap_interval(
    values: Sequence[float],
    families: Sequence[str],
    resamples: int,
    interval: float,
    rng: np.random.Generator,
) -> tuple[float, float]:
    """Percentile interval of the mean under a cluster bootstrap.

    Whole families are drawn with replacement; a draw's mean is over all parts in it.  With one
    family there is nothing to draw from, and the interval is the whole line's honest stand-in:
    the smallest and the largest value.
    """
    names = sorted(set(families))
    if len(names) < 2:
        return min(values), max(values)
    index = np.array([names.index(family) for family in families])
    sums = np.bincount(index, weights=values)
    counts = np.bincount(index)
    drawn = rng.integers(len(names), size=(resamples, len(names)))
    means = sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1)
    tail = (1 - interval) / 2
    low, high = np.quantile(means, [tail, 1 - tail])
    return float(low), float(high)
