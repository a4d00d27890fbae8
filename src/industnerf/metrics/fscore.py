"""Shares of points that lie near the other cloud."""

import math

import numpy as np
from jaxtyping import Float64

from industnerf.errors import MetricError
from industnerf.metrics.nearest_distances import NearestDistances


def share_within(distances: Float64[np.ndarray, "n"], threshold: float) -> float:
    """Share of points that have one of the other cloud no farther than `distance` away."""
    if not (math.isfinite(threshold) and threshold > 0):
        raise MetricError(f"a share within {threshold!r} is undefined; it takes a positive length")
    return float((distances <= threshold).mean())


def fscore(distances: NearestDistances, threshold: float) -> float:
    """Harmonic mean of precision and recall at `distance`; 0 where both are.

    Precision is the share of what was predicted near the truth, recall that of the truth near it
    -- Knapitsch et al. (2017), Tanks and Temples, eq. 5 to 8.
    """
    precision = share_within(distances.predicted_to_truth, threshold)
    recall = share_within(distances.truth_to_predicted, threshold)
    return 2 * precision * recall / (precision + recall) if precision + recall else 0.0
