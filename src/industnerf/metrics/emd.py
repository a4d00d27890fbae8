"""Earth mover's distance, exact and certified, of equal weights: W1, or W2 squared.

The solver is POT's network simplex.  It is given few of the n x m pairs, and finds the plan and
the dual potentials that are optimal among those.  The potentials are then tested on ALL pairs
(`column_generation`), those that violate them join, and it solves again, until there are none.
What is returned is proven (`duality_certificate`); where the sparse way does not get there, the
dense problem is solved, and proven alike; failing that too, there is an error and no number.

POT's `potentials_init` serves dense problems only.  A sparse one is warmed by handing it
reduced costs, which differ from the costs by a constant and start the simplex near its end.
"""

import math
import os
import warnings
from dataclasses import replace

import numpy as np
from jaxtyping import Float64, Int64
from scipy import sparse

from industnerf.errors import MetricError
from industnerf.metrics.cells import KdCells, WeightedCloud, kd_cells, normalize_clouds
from industnerf.metrics.cloud_validation import validate_cloud
from industnerf.metrics.column_generation import violated_pairs
from industnerf.metrics.dual_potentials import center_potentials, row_minimum
from industnerf.metrics.duality_certificate import (
    ABSOLUTE_GAP,
    CertifiedEmd,
    allowed_gap,
    certify,
    transport_cost,
)
from industnerf.metrics.ground_cost import EUCLIDEAN, SQUARED_EUCLIDEAN, GroundCost
from industnerf.metrics.transport_plan import TransportPlan, refine_plan

DENSE_PAIRS = 2**17  # so few pairs are solved all at once, in about 20 ms
DENSE_POINTS = 256  # so few points on one side as well
MAX_PIVOTS = 10**9  # a stop for a simplex gone astray: 8192 points take about 10**6
MAX_ROUNDS = 30  # 2 to 6 are usual
PAIRS_PER_POINT_AND_ROUND = 4  # pairs that may join in one round, per point
DROPPING_ROUNDS = 3  # not more: a pair might be dropped and come back for ever
ROW_BLOCK = 1024  # rows of the dense problem tested at a time

Cost = Float64[np.ndarray, "n m"] | sparse.coo_array


def emd(a: object, b: object, *, squared: bool = False) -> CertifiedEmd:
    """The earth mover's distance of two point clouds, with its plan and its proof.

    Exact optimal transport between equal weights: each point of `a` sends 1/n, each of `b` receives
    1/m -- Rubner et al. (2000), The earth mover's distance; eq. 14 of the paper.  It is the
    Wasserstein distance W1, the least mean distance over which one cloud is carried onto the other.

    - `a`, `b`: arrays, or what numpy makes one of, of shapes (n, 3) and (m, 3), in any unit of
      length, float32 or float64.  A point that is there twice weighs twice; other weights are
      not supported.
    - `squared`: by the square of the distance instead, W2 squared.  Another plan may be cheapest.

    Returns `value` in the clouds' unit, or its square; `plan`, at most n + m - 1 triples of row,
    column and mass; and as certificate `lower_bound` and `gap`, the difference of both.  The gap is
    at most 1e-9 of the value (or 2e-12 of the longest side of the box around both clouds, with
    squares 4e-12 of that squared).  Same clouds, same bytes.

    Takes about 0.2 s of one core at 4096 points a side; 1 to 4 s, seldom 8, and 400 MB at 16 384.
    Sides of very unequal numbers take long: up to 2 minutes and 1.5 GB for 256 and 100 000 points.

    Raises MetricError if a cloud is empty, not (n, 3) or not finite, or if the minimum cannot be
    proven: never is anything else returned.
    """
    return certified_emd(
        validate_cloud(a, "a"), validate_cloud(b, "b"), SQUARED_EUCLIDEAN if squared else EUCLIDEAN
    )


def certified_emd(
    a: Float64[np.ndarray, "n 3"],
    b: Float64[np.ndarray, "m 3"],
    ground: GroundCost = EUCLIDEAN,
    *,
    max_pivots: int = MAX_PIVOTS,
    max_rounds: int = MAX_ROUNDS,
) -> CertifiedEmd:
    """As `emd`, of finite clouds under any cost; `max_rounds=0` solves the dense problem."""
    left, right, unit = normalize_clouds(a, b)
    result, unit_cost = None, ground.of_length(unit)
    if max_rounds > 0 and not _is_small(left, right):
        result = _sparse_emd(left, right, ground, max_pivots, max_rounds)
    result = result or _dense_emd(left, right, ground, max_pivots)
    return replace(result, value=result.value * unit_cost, gap=result.gap * unit_cost)


def weighted_emd(a: WeightedCloud, b: WeightedCloud) -> float:
    """EMD of two small clouds of unequal weights, certified; their sums are the same.

    The clouds extend over about 1 unit, as `normalize_clouds` has it.  Raises as `emd`.
    """
    return _dense_emd(a, b, EUCLIDEAN, MAX_PIVOTS).value


def _sparse_emd(
    a: WeightedCloud, b: WeightedCloud, ground: GroundCost, max_pivots: int, max_rounds: int
) -> CertifiedEmd | None:
    """The proven cost from few pairs, or None if they do not yield it."""
    try:
        cells, plan, pair_ids = _initial_solution(a, b, ground, max_pivots)
        for rounds in range(1, max_rounds + 1):
            plan = _solve_sparse(a, b, ground, pair_ids, (plan.u, plan.v), max_pivots)
            value = transport_cost(a, b, plan, ground)
            if value <= ABSOLUTE_GAP:  # proven without potentials
                return certify(a, b, plan, ground, -math.inf, rounds, len(pair_ids))
            min_reduced_cost = -allowed_gap(value) / 10
            rows, cols, reduced = violated_pairs(
                a.points, b.points, cells, (plan.u, plan.v), min_reduced_cost, ground
            )
            if not len(rows):
                return certify(a, b, plan, ground, min_reduced_cost, rounds, len(pair_ids))
            if rounds <= DROPPING_ROUNDS:
                pair_ids = _tight_pairs(a, b, plan, pair_ids, -reduced.min(), ground)
            pair_ids = _merge_pairs(
                pair_ids, rows * len(b.mass) + cols, reduced, len(a.mass) + len(b.mass)
            )
    except MetricError:
        return None
    return None


def _dense_emd(
    a: WeightedCloud, b: WeightedCloud, ground: GroundCost, max_pivots: int
) -> CertifiedEmd:
    """The proven cost from all pairs at once."""
    plan = _solve_dense(a, b, ground, max_pivots)
    block_minima = [
        (ground.matrix(a.points[rows], b.points) - plan.u[rows, None] - plan.v).min()
        for rows in np.array_split(np.arange(len(a.mass)), -(-len(a.mass) // ROW_BLOCK))
    ]
    min_reduced_cost = min(0.0, float(min(block_minima)))
    return certify(a, b, plan, ground, min_reduced_cost, 0, len(a.mass) * len(b.mass))


def _initial_solution(
    a: WeightedCloud, b: WeightedCloud, ground: GroundCost, max_pivots: int
) -> tuple[tuple[KdCells, KdCells], TransportPlan, Int64[np.ndarray, "k"]]:
    """Cells, first potentials and first candidate pairs, from a solution of the coarser problem."""
    cells = kd_cells(a), kd_cells(b)
    coarse = _coarse_plan(cells[0].coarse, cells[1].coarse, ground, max_pivots)
    plan, rows, cols = refine_plan(a, b, cells, coarse, ground)
    return cells, plan, _sorted_unique(rows * len(b.mass) + cols)


def _coarse_plan(
    a: WeightedCloud, b: WeightedCloud, ground: GroundCost, max_pivots: int
) -> TransportPlan:
    """A plan that is optimal among its candidates, and not tested on other pairs."""
    if _is_small(a, b):
        return _solve_dense(a, b, ground, max_pivots)
    _, plan, pair_ids = _initial_solution(a, b, ground, max_pivots)
    return _solve_sparse(a, b, ground, pair_ids, (plan.u, plan.v), max_pivots)


def _is_small(a: WeightedCloud, b: WeightedCloud) -> bool:
    n, m = len(a.mass), len(b.mass)
    return n * m <= DENSE_PAIRS or min(n, m) <= DENSE_POINTS


def _tight_pairs(
    a: WeightedCloud,
    b: WeightedCloud,
    plan: TransportPlan,
    pair_ids: Int64[np.ndarray, "k"],
    max_reduced: float,
    ground: GroundCost,
) -> Int64[np.ndarray, "j"]:
    """The pairs of `plan`, and those of `pair_ids` whose reduced cost is below `max_reduced`.

    The solver's time goes by their number.  Potentials seldom change by more than the largest
    violation; what is missed all the same, `violated_pairs` finds again.
    """
    rows, cols = np.divmod(pair_ids, len(b.mass))
    reduced = ground.rowwise(a.points[rows], b.points[cols]) - plan.u[rows] - plan.v[cols]
    return np.concatenate([pair_ids[reduced < max_reduced], plan.rows * len(b.mass) + plan.cols])


def _merge_pairs(
    pair_ids: Int64[np.ndarray, "k"],
    new_ids: Int64[np.ndarray, "f"],
    reduced: Float64[np.ndarray, "f"],
    num_points: int,
) -> Int64[np.ndarray, "j"]:
    """`pair_ids` and the pairs of `new_ids` with the least reduced cost."""
    max_new = PAIRS_PER_POINT_AND_ROUND * num_points
    if len(new_ids) > max_new:
        new_ids = new_ids[np.argpartition(reduced, max_new)[:max_new]]
    return _sorted_unique(np.concatenate([pair_ids, new_ids]))


def _sorted_unique(pair_ids: Int64[np.ndarray, "k"]) -> Int64[np.ndarray, "d"]:
    """np.unique, which hashes and is some 20 times slower than numpy's sort."""
    pair_ids = np.sort(pair_ids)
    return pair_ids[np.diff(pair_ids, prepend=-1) > 0]


def _solve_sparse(
    a: WeightedCloud,
    b: WeightedCloud,
    ground: GroundCost,
    pair_ids: Int64[np.ndarray, "k"],
    potentials: tuple[Float64[np.ndarray, "n"], Float64[np.ndarray, "m"]],
    max_pivots: int,
) -> TransportPlan:
    """The best plan on the pairs (i, j) = divmod(id, m), from `potentials` near optimal ones."""
    rows, cols = np.divmod(pair_ids, len(b.mass))
    cost = ground.rowwise(a.points[rows], b.points[cols])
    reduced = cost - potentials[0][rows] - potentials[1][cols]
    shape = (len(a.mass), len(b.mass))
    # Not below 0: POT weighs "infeasible" against the largest cost, not the most negative.
    cost_matrix = sparse.coo_array((reduced - reduced.min(), (rows, cols)), shape)
    flow, v = _network_simplex(a, b, cost_matrix, max_pivots)
    support = flow.row.astype(np.int64), flow.col.astype(np.int64)
    u = row_minimum(reduced - v[cols], rows)
    u, v = center_potentials((rows, cols), reduced, support, (u, v))
    return TransportPlan(*support, flow.data, potentials[0] + u, potentials[1] + v)


def _solve_dense(
    a: WeightedCloud, b: WeightedCloud, ground: GroundCost, max_pivots: int
) -> TransportPlan:
    """The best plan of the dense problem, with potentials as high as all pairs allow."""
    cost = ground.matrix(a.points, b.points)
    flow, v = _network_simplex(a, b, cost, max_pivots)
    rows, cols = np.nonzero(flow)
    cost -= v
    u = cost.min(axis=1)
    cost -= u[:, None]
    return TransportPlan(rows, cols, flow[rows, cols], u, v + cost.min(axis=0))


def _network_simplex(
    a: WeightedCloud, b: WeightedCloud, cost: Cost, max_pivots: int
) -> tuple[Cost, Float64[np.ndarray, "m"]]:
    """POT's network simplex on a dense or sparse cost >= 0: the flow and the potentials of `b`.

    The potentials of `a` follow from these.  POT's own depend on arcs of the cost
    (n + m) (max cost + 1), and carry their rounding; scaling the cost up makes that 1 vanish.
    """
    for backend in ("PYTORCH", "JAX", "CUPY", "TENSORFLOW"):  # numpy is enough, and loads fast
        os.environ.setdefault(f"POT_BACKEND_DISABLE_{backend}", "1")
    import ot

    largest = (cost.data if sparse.issparse(cost) else cost).max()
    scale = math.ldexp(1.0, 20 - math.frexp(max(largest, 1e-9))[1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # POT's verdict is in the log
        flow, log = ot.emd(a.mass, b.mass, cost * scale, numItermax=max_pivots, log=True)
    if log["warning"]:
        raise MetricError(
            f"POT did not solve the transport of {len(a.mass)} to {len(b.mass)} points within "
            f"max_pivots={max_pivots}: {log['warning']}"
        )
    return flow, log["v"] / scale
