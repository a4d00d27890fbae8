"""Distances of each point to the nearest of the other cloud, and the Chamfer distance and F-score
that are made of them.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float64
from pykdtree.kdtree import KDTree

from industnerf.errors import MetricError
from industnerf.metrics.cloud_validation import validate_cloud


@dataclass(frozen=True)
class NearestDistances:
    """Distances from the points of each cloud, in the unit of both."""

    truth_to_predicted: Float64[np.ndarray, "m"]  # to the prediction
    predicted_to_truth: Float64[np.ndarray, "n"]  # to the truth


def nearest_distances(
    truth: Float[np.ndarray, "m 3"], predicted: Float[np.ndarray, "n 3"]
) -> NearestDistances:
    """Both ways at once: Chamfer, F-score and Hausdorff-95 are all made of these.

    Raises MetricError if a cloud is empty or not finite.
    """
    truth, predicted = validate_cloud(truth, "truth"), validate_cloud(predicted, "predicted")
    return NearestDistances(
        distance_to_nearest(truth, predicted), distance_to_nearest(predicted, truth)
    )


def distance_to_nearest(
    a: Float64[np.ndarray, "n 3"], b: Float64[np.ndarray, "m 3"]
) -> Float64[np.ndarray, "n"]:
    """Distance of each point of `a` to the nearest of `b`, exact.

    pykdtree finds what SciPy's tree finds, five times as fast where the clouds are far apart.
    """
    return KDTree(b).query(a)[0]


def chamfer(distances: NearestDistances) -> float:
    """First-order Chamfer distance: mean of the two directed mean distances, in the clouds' unit.

    (mean_i min_j |a_i - b_j| + mean_j min_i |a_i - b_j|) / 2: half the sum that others report,
    and no square.
    """
    return float((distances.truth_to_predicted.mean() + distances.predicted_to_truth.mean()) / 2)


def share_within(distances: Float64[np.ndarray, "n"], threshold: float) -> float:
    """Share of points at most `threshold` from the other cloud."""
    if not (math.isfinite(threshold) and threshold > 0):
        raise MetricError(f"a share within {threshold!r} is undefined; it takes a positive length")
    return float((distances <= threshold).mean())


def fscore(distances: NearestDistances, threshold: float) -> float:
    """Harmonic mean of precision and recall at `threshold`; 0 where both are.

    Precision is the share of the prediction near the truth, recall that of the truth near it
    -- Knapitsch et al. (2017), Tanks and Temples, eq. 5 to 8.
    """
    precision = share_within(distances.predicted_to_truth, threshold)
    recall = share_within(distances.truth_to_predicted, threshold)
    return 2 * precision * recall / (precision + recall) if precision + recall else 0.0
