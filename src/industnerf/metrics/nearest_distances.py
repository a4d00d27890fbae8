"""How far each point of either cloud is from the nearest of the other."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float64
from pykdtree.kdtree import KDTree

from industnerf.metrics.cloud_validation import validate_cloud


@dataclass(frozen=True)
class NearestDistances:
    """Distances from the points of each cloud, in the unit of both."""

    truth_to_predicted: Float64[np.ndarray, "m"]  # to what was predicted
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
