"""Shares of points that lie near the other cloud."""

import math

import numpy as np
from jaxtyping import Float64

from industnerf.errors import MetricError
from industnerf.metrics.gaps import Gaps


def share_within(gaps: Float64[np.ndarray, "n"], distance: float) -> float:
    """Share of points that have one of the other cloud no farther than `distance` away."""
    if not (math.isfinite(distance) and distance > 0):
        raise MetricError(f"a share within {distance!r} is undefined; it takes a positive length")
    return float((gaps <= distance).mean())


def fscore(gaps: Gaps, distance: float) -> float:
    """Harmonic mean of precision and recall at `distance`; 0 where both are.

    Precision is the share of what was predicted near the truth, recall that of the truth near it
    -- Knapitsch et al. (2017), Tanks and Temples, eq. 5 to 8.
    """
    precision = share_within(gaps.predicted, distance)
    recall = share_within(gaps.truth, distance)
    return 2 * precision * recall / (precision + recall) if precision + recall else 0.0
