"""One cloud under every protocol that the paper's section 4.3 may mean: R13.

The paper prints an EMD and says neither how many points are compared, nor how they are chosen, in
which unit, by which ground cost, nor whether the inside of a part counts.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from jaxtyping import Float

from industnerf.metrics.compare import Sampled
from industnerf.metrics.emd import emd, squared_emd
from industnerf.metrics.reduce import farthest_points, random_points

POINTS = (1024, 2048, 4096)  # on either side
MANY = 8192  # of a few parts: it takes seconds
REDUCTIONS, SURFACES = ("even", "iid"), ("visible", "full")


@dataclass(frozen=True)
class Cell:
    """An EMD under one protocol; `scale` is the length of the true box that is 1."""

    points: int
    reduction: str  # even, iid: of the prediction; the truth is always even
    surface: str  # visible, full
    cost: str  # distance, squared
    scale: str  # diagonal, longest: edge
    value: float


def grid(
    truth: Sampled,
    predicted: Sampled,
    diagonals: float,
    points: tuple[int, ...],
    rng: np.random.Generator,
) -> list[Cell]:
    """The cells of a cloud; `diagonals` is how long the diagonal is in longest edges.

    A cell is left out if either side has fewer points than it asks for.
    """
    found = []
    for surface, count in product(SURFACES, points):
        whole, cloud = (_of(side, surface) for side in (truth, predicted))
        if min(len(whole), len(cloud)) < count:
            continue
        few = farthest_points(whole, count)
        for reduction in REDUCTIONS:
            chosen = (
                farthest_points(cloud, count)
                if reduction == "even"
                else random_points(cloud, count, rng)
            )
            about = (count, reduction, surface)
            found += _scaled(about, "distance", emd(few, chosen), diagonals)
            found += _scaled(about, "squared", squared_emd(few, chosen), diagonals**2)
    return found


def _of(side: Sampled, surface: str) -> Float[np.ndarray, "n 3"]:
    return side.points if surface == "full" else side.points[side.kept]


def _scaled(about: tuple, cost: str, value: float, longer: float) -> list[Cell]:
    """In diagonals and in longest edges: a change of unit needs no second solution."""
    return [
        Cell(*about, cost, "diagonal", value),
        Cell(*about, cost, "longest", value * longer),
    ]
