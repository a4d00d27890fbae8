"""Chamfer distance, of first order: distances are not squared."""

from industnerf.metrics.gaps import Gaps


def chamfer(gaps: Gaps) -> float:
    """Mean of the two directed mean distances, in the clouds' unit.

    (mean_i min_j |a_i - b_j| + mean_j min_i |a_i - b_j|) / 2 -- half of what those report who
    add the two, and no square.
    """
    return float((gaps.truth.mean() + gaps.predicted.mean()) / 2)
