"""Whether a cloud has points enough, and as many everywhere, for its score to be about its shape.

Protocol P1 compares farthest points, which are spread evenly.  A cloud that has hardly more points
than are compared cannot be thinned to them: gaps that chance left count as error.
"""

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from industnerf.artifacts.part import Mesh
from industnerf.geometry.sampling import sample_surface
from industnerf.metrics.subsample import farthest_points

# What a perfect random sample scores, in floors, by its points over those that are compared:
# the mean over three dev parts (benchmarks/results.md).
SHARES, FLOORS = (1 / 8, 1 / 4, 1 / 2, 1, 2, 4), (3.8, 2.7, 2.5, 1.65, 1.16, 1.03)
SAMPLES = 16384  # of the true surface, to measure areas by
POINTS_PER_CELL = 50  # their number varies by 14 %
MIN_CELLS, MAX_CELLS = 8, 128
MAX_RATIO = 4.0  # of densities; 1.5 is chance, and a cut through a cell makes 2


def density_warnings(
    points: Float[np.ndarray, "n 3"], mesh: Mesh, compared: int, rng: np.random.Generator
) -> list[str]:
    """Remarks on a cloud of few points, or of uneven density, of the part `mesh`; both in mm.

    `compared` is the number of points that the protocol compares.
    """
    return [*_count_warnings(len(points), compared), *_evenness_warnings(points, mesh, rng)]


def _count_warnings(count: int, compared: int) -> list[str]:
    enough = int(SHARES[-1] * compared)
    if count >= enough:
        return []
    floors = np.interp(np.log(count / compared), np.log(SHARES), FLOORS)
    choice = (
        f"{count} points, fewer than the {compared} that are compared"
        if count < compared
        else f"{count} points, of which the {compared} most evenly spread are compared"
    )
    return [
        f"{choice}: so many perfect points at random, whose density is uneven by chance, score "
        f"about {floors:.2g} floors; write {enough} or more"
    ]


def _evenness_warnings(points: np.ndarray, mesh: Mesh, rng: np.random.Generator) -> list[str]:
    """The densities of the sparsest and the densest tenth of the surface that has points."""
    num_cells = int(np.clip(len(points) // POINTS_PER_CELL, MIN_CELLS, MAX_CELLS))
    samples = sample_surface(mesh.vertices, mesh.faces, SAMPLES, rng)[0]
    centers = cKDTree(farthest_points(samples, num_cells))
    areas, counts = (
        np.bincount(centers.query(each)[1], minlength=num_cells) / len(each)
        for each in (samples, points)
    )
    covered = (counts > 0) & (areas > 0)
    density, weight = counts[covered] / areas[covered], areas[covered]
    order = np.argsort(density)
    rank = np.cumsum(weight[order]) / weight.sum()
    low, high = np.interp((0.1, 0.9), rank, density[order])
    if high < MAX_RATIO * low:
        return []
    return [
        f"its density is uneven: the densest tenth of the surface has {high / low:.2g} times as "
        "many points for its area as the sparsest; P1-even evens that out, Chamfer does not"
    ]
