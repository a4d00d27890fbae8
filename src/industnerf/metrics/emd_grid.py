"""One cloud under every protocol that the paper's section 4.3 may mean: R13.

The paper prints an EMD and says neither how many points are compared, nor how they are chosen, in
which unit, by which ground cost, nor whether the inside of a part counts.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from jaxtyping import Float

from industnerf.metrics.compare import SampledSurface
from industnerf.metrics.emd import emd, squared_emd
from industnerf.metrics.subsample import farthest_points, random_points

POINT_COUNTS = (1024, 2048, 4096)  # on either side
LARGE_POINT_COUNT = 8192  # of a few parts: it takes seconds
REDUCTIONS, SURFACES = ("even", "iid"), ("visible", "full")


@dataclass(frozen=True)
class GridCell:
    """An EMD under one protocol; `scale` is the length of the true box that is 1."""

    points: int
    reduction: str  # even, iid: of the prediction; the truth is always even
    surface: str  # visible, full
    cost: str  # distance, squared
    scale: str  # diagonal, longest: edge
    value: float


def emd_grid(
    truth: SampledSurface,
    predicted: SampledSurface,
    diagonal_in_edges: float,
    point_counts: tuple[int, ...],
    rng: np.random.Generator,
) -> list[GridCell]:
    """The cells of a cloud; `diagonals` is how long the diagonal is in longest edges.

    A cell is left out if either side has fewer points than it asks for.
    """
    cells = []
    for surface, count in product(SURFACES, point_counts):
        truth_points, predicted_points = (_points_on(side, surface) for side in (truth, predicted))
        if min(len(truth_points), len(predicted_points)) < count:
            continue
        truth_subset = farthest_points(truth_points, count)
        for reduction in REDUCTIONS:
            predicted_subset = (
                farthest_points(predicted_points, count)
                if reduction == "even"
                else random_points(predicted_points, count, rng)
            )
            protocol = (count, reduction, surface)
            cells += _in_both_units(
                protocol, "distance", emd(truth_subset, predicted_subset), diagonal_in_edges
            )
            cells += _in_both_units(
                protocol,
                "squared",
                squared_emd(truth_subset, predicted_subset),
                diagonal_in_edges**2,
            )
    return cells


def _points_on(side: SampledSurface, surface: str) -> Float[np.ndarray, "n 3"]:
    return side.points if surface == "full" else side.points[side.evaluated]


def _in_both_units(protocol: tuple, cost: str, value: float, factor: float) -> list[GridCell]:
    """In diagonals and in longest edges: a change of unit needs no second solution."""
    return [
        GridCell(*protocol, cost, "diagonal", value),
        GridCell(*protocol, cost, "longest", value * factor),
    ]
