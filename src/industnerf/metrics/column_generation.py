"""Column generation: which of ALL n x m pairs violate the dual constraints?

Dual potentials `u`, `v` prove a lower bound of the transport cost when no pair has a cost
c(a_i, b_j) below u_i + v_j.  Most pairs cost far more, so whole pairs of cells are skipped at once:

    c(x, y) - u - v  >=  c(|c_A - c_B| - r_A - r_B) - max u - max v   for x in A, y in B,

and only the rest are computed point by point.  Nothing is estimated.
"""

import numpy as np
from jaxtyping import Float64, Int64
from scipy.spatial.distance import cdist

from industnerf.metrics.cells import KdCells
from industnerf.metrics.ground_cost import GroundCost

# Rounding of the bound above: a few times 2^-52 of lengths, and squares, of about 1 (see
# cells.normalize_clouds).
ROUNDING = 1e-13
CHUNK = 2**14  # pairs of cells at a time: a few MB


def violated_pairs(
    a: Float64[np.ndarray, "n 3"],
    b: Float64[np.ndarray, "m 3"],
    cells: tuple[KdCells, KdCells],
    potentials: tuple[Float64[np.ndarray, "n"], Float64[np.ndarray, "m"]],
    limit: float,
    ground: GroundCost,
) -> tuple[Int64[np.ndarray, "k"], Int64[np.ndarray, "k"], Float64[np.ndarray, "k"]]:
    """Every (i, j) whose reduced cost c(a_i, b_j) - u_i - v_j is below `limit`, and that cost."""
    (cells_a, cells_b), (u, v) = cells, potentials
    points_a, points_b = a[cells_a.members], b[cells_b.members]
    u_a, v_b = _padded(cells_a, u), _padded(cells_b, v)
    max_potentials = u_a.max(axis=1), v_b.max(axis=1)
    cell_a, cell_b = _candidate_cells(cells_a, cells_b, *max_potentials, limit, ground)
    violations = []
    for start in range(0, max(len(cell_a), 1), CHUNK):  # at least once: an empty answer has a shape
        p, q = cell_a[start : start + CHUNK], cell_b[start : start + CHUNK]
        reduced = ground.between_cells(points_a[p], points_b[q])
        reduced -= u_a[p][:, :, None]
        reduced -= v_b[q][:, None, :]
        # Faster than np.nonzero of three axes.
        k, s, t = np.unravel_index(np.flatnonzero(reduced < limit), reduced.shape)
        violations.append((cells_a.members[p[k], s], cells_b.members[q[k], t], reduced[k, s, t]))
    rows, cols, costs = (np.concatenate(part) for part in zip(*violations, strict=True))
    return rows, cols, costs


def _padded(
    cells: KdCells, potential: Float64[np.ndarray, "n"]
) -> Float64[np.ndarray, "cells size"]:
    """Potentials cell by cell; a pad has -inf, which makes its pairs' reduced cost infinite."""
    return np.where(cells.members < 0, -np.inf, potential[cells.members])


def _candidate_cells(
    cells_a: KdCells,
    cells_b: KdCells,
    max_u: Float64[np.ndarray, "p"],
    max_v: Float64[np.ndarray, "q"],
    limit: float,
    ground: GroundCost,
) -> tuple[Int64[np.ndarray, "k"], Int64[np.ndarray, "k"]]:
    """Pairs of cells that the bound does not rule out."""
    bound = cdist(cells_a.coarse.points, cells_b.coarse.points)
    bound -= cells_a.radius[:, None]
    bound -= cells_b.radius
    bound = ground.lower_bound(bound)
    bound -= max_u[:, None]
    bound -= max_v
    rows, cols = np.nonzero(bound < limit + ROUNDING)
    return rows, cols
