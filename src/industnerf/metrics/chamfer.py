"""Chamfer distance, of first order: distances are not squared."""

from industnerf.metrics.nearest_distances import NearestDistances


def chamfer(distances: NearestDistances) -> float:
    """Mean of the two directed mean distances, in the clouds' unit.

    (mean_i min_j |a_i - b_j| + mean_j min_i |a_i - b_j|) / 2 -- half of what those report who
    add the two, and no square.
    """
    return float((distances.truth_to_predicted.mean() + distances.predicted_to_truth.mean()) / 2)
