"""From the plan of a coarse transport problem to the candidate pairs of the fine one.

A pair is a candidate when its reduced cost c(a_i, b_j) - u_i - v_j is small, not when its
points are near: a cloud that must travel is then no harder than one that stays.  The coarse
plan, spread over the points, joins the candidates, so that they always admit a plan.

A guess throughout: what it misses, `column_generation` finds.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.metrics.cells import KdCells, WeightedCloud
from industnerf.metrics.ground_cost import GroundCost

NEAREST_CELLS = 32  # cells of the other cloud that a cell looks at
CANDIDATES_PER_POINT = 14  # candidates of each point
CHUNK = 256  # cells at a time: a few MB


@dataclass(frozen=True)
class TransportPlan:
    """Mass carried from points `rows` to points `cols`, and the dual potentials that go with it."""

    rows: Int64[np.ndarray, "k"]
    cols: Int64[np.ndarray, "k"]
    flow: Float64[np.ndarray, "k"]
    u: Float64[np.ndarray, "n"]
    v: Float64[np.ndarray, "m"]


def refine_plan(
    a: WeightedCloud,
    b: WeightedCloud,
    cells: tuple[KdCells, KdCells],
    coarse: TransportPlan,
    ground: GroundCost,
) -> tuple[TransportPlan, Int64[np.ndarray, "k"], Int64[np.ndarray, "k"]]:
    """A feasible plan between the points, with potentials, and the candidates (i, j) around it."""
    cells_a, cells_b = cells
    near_a = _nearest_cells(cells_a, cells_b, coarse.v, ground)
    near_b = _nearest_cells(cells_b, cells_a, coarse.u, ground)
    u = _extend_potentials(a, cells_a, cells_b, coarse.v, near_a, ground)
    v = _extend_potentials(b, cells_b, cells_a, coarse.u, near_b, ground)
    plan = TransportPlan(*_distribute_flow(a, b, cells, coarse), u, v)
    row, col = _candidate_pairs(a, b, cells_a, cells_b, v, near_a, ground)
    col2, row2 = _candidate_pairs(b, a, cells_b, cells_a, u, near_b, ground)
    return plan, np.concatenate([plan.rows, row, row2]), np.concatenate([plan.cols, col, col2])


def _nearest_cells(
    own_cells: KdCells, other_cells: KdCells, v: Float64[np.ndarray, "q"], ground: GroundCost
) -> Int64[np.ndarray, "p k"]:
    """The cells of `other_cells` with the smallest reduced cost from each cell of `own_cells`."""
    k, nearest = min(NEAREST_CELLS, len(v)), []
    for start in range(0, len(own_cells.coarse.points), CHUNK):
        own = own_cells.coarse.points[start : start + CHUNK]
        reduced = ground.matrix(own, other_cells.coarse.points) - v
        nearest.append(np.argpartition(reduced, k - 1, axis=1)[:, :k])
    return np.concatenate(nearest)


def _extend_potentials(
    cloud: WeightedCloud,
    own_cells: KdCells,
    other_cells: KdCells,
    v: Float64[np.ndarray, "q"],
    near: Int64[np.ndarray, "p k"],
    ground: GroundCost,
) -> Float64[np.ndarray, "n"]:
    """u_i = min_J c(a_i, c_J) - V_J over the near cells: the coarse potentials, extended."""
    cost = ground.between_cells(cloud.points[own_cells.members], other_cells.coarse.points[near])
    best = (cost - v[near][:, None, :]).min(axis=2)
    u, is_member = np.empty(len(cloud.points)), own_cells.members >= 0
    u[own_cells.members[is_member]] = best[is_member]
    return u


def _candidate_pairs(
    a: WeightedCloud,
    b: WeightedCloud,
    own_cells: KdCells,
    other_cells: KdCells,
    v: Float64[np.ndarray, "m"],
    near: Int64[np.ndarray, "p k"],
    ground: GroundCost,
) -> tuple[Int64[np.ndarray, "c"], Int64[np.ndarray, "c"]]:
    """For each point of `a` CANDIDATES_PER_POINT of the near cells with least c(a_i, b_j) - v_j."""
    candidates = []
    for start in range(0, len(near), CHUNK):
        rows = own_cells.members[start : start + CHUNK]
        cols = other_cells.members[near[start : start + CHUNK]].reshape(len(rows), -1)
        reduced = ground.between_cells(a.points[rows], b.points[cols]) - v[cols][:, None, :]
        k = min(CANDIDATES_PER_POINT, cols.shape[1])
        best = np.argpartition(reduced, k - 1, axis=2)[:, :, :k]
        j = np.take_along_axis(np.broadcast_to(cols[:, None, :], reduced.shape), best, axis=2)
        i = np.broadcast_to(rows[:, :, None], j.shape)
        is_member = (i >= 0) & (j >= 0)
        candidates.append((i[is_member], j[is_member]))
    rows, cols = (np.concatenate(part) for part in zip(*candidates, strict=True))
    return rows, cols


def _distribute_flow(
    a: WeightedCloud, b: WeightedCloud, cells: tuple[KdCells, KdCells], coarse: TransportPlan
) -> tuple[Int64[np.ndarray, "k"], Int64[np.ndarray, "k"], Float64[np.ndarray, "k"]]:
    """Hand each coarse flow a stretch of its two cells' points, first come, first served.

    Both clouds are laid on a line of mass, cell after cell, and each flow is a stretch of both
    lines.  Every point's end on either line is a cut; between two cuts lies one pair.
    """
    order_a, order_b = cells[0].order, cells[1].order
    has_flow = coarse.flow > 0.5  # flows are whole
    flow = np.round(coarse.flow[has_flow])
    source = coarse.rows[has_flow]
    target = coarse.cols[has_flow]
    a_order, b_order = np.lexsort((target, source)), np.lexsort((source, target))
    start_a, start_b = _flow_starts(flow, a_order), _flow_starts(flow, b_order)
    end_a, end_b = np.cumsum(a.mass[order_a]), np.cumsum(b.mass[order_b])
    b_flow = b_order[np.searchsorted(start_b[b_order], end_b, side="left") - 1]
    cuts = np.unique(np.concatenate([end_a, start_a, start_a[b_flow] + end_b - start_b[b_flow]]))
    cut_starts = cuts[:-1]
    a_flow = a_order[np.searchsorted(start_a[a_order], cut_starts, side="right") - 1]
    rows = order_a[np.searchsorted(end_a, cut_starts, side="right")]
    cols = order_b[
        np.searchsorted(end_b, start_b[a_flow] + cut_starts - start_a[a_flow], side="right")
    ]
    return rows, cols, np.diff(cuts)


def _flow_starts(
    flow: Float64[np.ndarray, "k"], order: Int64[np.ndarray, "k"]
) -> Float64[np.ndarray, "k"]:
    """Where each flow begins when the flows are laid end to end in `order`."""
    starts = np.empty(len(flow))
    starts[order] = np.cumsum(flow[order]) - flow[order]
    return starts
