"""From the plan of a coarse transport problem to the pairs worth trying in the fine one.

A pair is worth trying when its reduced cost c(a_i, b_j) - u_i - v_j is small, not when its
points are near: a cloud that must travel is then no harder than one that stays.  The coarse
plan, spread over the points, joins the candidates, so that they always admit a plan.

A guess throughout: what it misses, `pricing` finds.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.metrics.cells import Cells, Cloud
from industnerf.metrics.ground import Ground

NEAR_CELLS = 32  # cells of the other cloud that a cell looks at
PER_POINT = 14  # candidates of each point
CHUNK = 256  # cells at a time: a few MB


@dataclass(frozen=True)
class Plan:
    """Mass carried from points `rows` to points `cols`, and the prices that go with it."""

    rows: Int64[np.ndarray, "k"]
    cols: Int64[np.ndarray, "k"]
    flow: Float64[np.ndarray, "k"]
    u: Float64[np.ndarray, "n"]
    v: Float64[np.ndarray, "m"]


def refine(
    a: Cloud, b: Cloud, cells: tuple[Cells, Cells], coarse: Plan, ground: Ground
) -> tuple[Plan, Int64[np.ndarray, "k"], Int64[np.ndarray, "k"]]:
    """A feasible plan between the points, with prices, and the candidates (i, j) around it."""
    cells_a, cells_b = cells
    near_a = _near(cells_a, cells_b, coarse.v, ground)
    near_b = _near(cells_b, cells_a, coarse.u, ground)
    u = _prices(a, cells_a, cells_b, coarse.v, near_a, ground)
    v = _prices(b, cells_b, cells_a, coarse.u, near_b, ground)
    plan = Plan(*_spread(a, b, cells, coarse), u, v)
    row, col = _cheapest(a, b, cells_a, cells_b, v, near_a, ground)
    col2, row2 = _cheapest(b, a, cells_b, cells_a, u, near_b, ground)
    return plan, np.concatenate([plan.rows, row, row2]), np.concatenate([plan.cols, col, col2])


def _near(
    here: Cells, there: Cells, v: Float64[np.ndarray, "q"], ground: Ground
) -> Int64[np.ndarray, "p k"]:
    """The cells of `there` with the smallest reduced cost from each cell of `here`."""
    k = min(NEAR_CELLS, len(v))
    reduced = ground.table(here.coarse.points, there.coarse.points) - v
    return np.argpartition(reduced, k - 1, axis=1)[:, :k]


def _prices(
    cloud: Cloud,
    here: Cells,
    there: Cells,
    v: Float64[np.ndarray, "q"],
    near: Int64[np.ndarray, "p k"],
    ground: Ground,
) -> Float64[np.ndarray, "n"]:
    """u_i = min_J c(a_i, c_J) - V_J over the near cells: the coarse prices, extended."""
    cost = ground.between_cells(cloud.points[here.members], there.coarse.points[near])
    best = (cost - v[near][:, None, :]).min(axis=2)
    u, real = np.empty(len(cloud.points)), here.members >= 0
    u[here.members[real]] = best[real]
    return u


def _cheapest(
    a: Cloud,
    b: Cloud,
    here: Cells,
    there: Cells,
    v: Float64[np.ndarray, "m"],
    near: Int64[np.ndarray, "p k"],
    ground: Ground,
) -> tuple[Int64[np.ndarray, "c"], Int64[np.ndarray, "c"]]:
    """For each point of `a`, those `PER_POINT` of the near cells with least c(a_i, b_j) - v_j."""
    found = []
    for start in range(0, len(near), CHUNK):
        rows = here.members[start : start + CHUNK]
        cols = there.members[near[start : start + CHUNK]].reshape(len(rows), -1)
        reduced = ground.between_cells(a.points[rows], b.points[cols]) - v[cols][:, None, :]
        k = min(PER_POINT, cols.shape[1])
        best = np.argpartition(reduced, k - 1, axis=2)[:, :, :k]
        j = np.take_along_axis(np.broadcast_to(cols[:, None, :], reduced.shape), best, axis=2)
        i = np.broadcast_to(rows[:, :, None], j.shape)
        real = (i >= 0) & (j >= 0)
        found.append((i[real], j[real]))
    rows, cols = (np.concatenate(part) for part in zip(*found, strict=True))
    return rows, cols


def _spread(
    a: Cloud, b: Cloud, cells: tuple[Cells, Cells], coarse: Plan
) -> tuple[Int64[np.ndarray, "k"], Int64[np.ndarray, "k"], Float64[np.ndarray, "k"]]:
    """Hand each coarse flow a stretch of its two cells' points, first come, first served.

    Both clouds are laid on a line of mass, cell after cell, and each flow is a stretch of both
    lines.  Every point's end on either line is a cut; between two cuts lies one pair.
    """
    order_a, order_b = cells[0].order, cells[1].order
    used = coarse.flow > 0.5  # flows are whole
    flow, source, target = np.round(coarse.flow[used]), coarse.rows[used], coarse.cols[used]
    by_a, by_b = np.lexsort((target, source)), np.lexsort((source, target))
    on_a, on_b = _starts(flow, by_a), _starts(flow, by_b)
    end_a, end_b = np.cumsum(a.mass[order_a]), np.cumsum(b.mass[order_b])
    holder = by_b[np.searchsorted(on_b[by_b], end_b, side="left") - 1]
    cuts = np.unique(np.concatenate([end_a, on_a, on_a[holder] + end_b - on_b[holder]]))
    begin = cuts[:-1]
    carrier = by_a[np.searchsorted(on_a[by_a], begin, side="right") - 1]
    rows = order_a[np.searchsorted(end_a, begin, side="right")]
    cols = order_b[np.searchsorted(end_b, on_b[carrier] + begin - on_a[carrier], side="right")]
    return rows, cols, np.diff(cuts)


def _starts(
    flow: Float64[np.ndarray, "k"], order: Int64[np.ndarray, "k"]
) -> Float64[np.ndarray, "k"]:
    """Where each flow begins when the flows are laid end to end in `order`."""
    starts = np.empty(len(flow))
    starts[order] = np.cumsum(flow[order]) - flow[order]
    return starts
