"""Earth mover's distance, exact and proven, of equal weights: W1, or W2 squared.

The solver is POT's network simplex.  It is given few of the n x m pairs, and finds the plan and
the prices that are optimal among those.  The prices are then held against ALL pairs (`pricing`),
those that undercut them join, and it solves again, until there are none.  What is returned is
proven (`proof`); where the sparse way does not get there, the dense problem is solved, and proven
alike; failing that too, there is an error and no number.

POT's `potentials_init` serves dense problems only.  A sparse one is warmed by handing it
reduced costs, which differ from the costs by a constant and start the simplex near its end.
"""

import math
import os
import warnings
from dataclasses import replace

import numpy as np
from jaxtyping import Float, Float64, Int64
from scipy import sparse

from industnerf.errors import MetricError
from industnerf.metrics.cells import Cells, Cloud, divide, weighted
from industnerf.metrics.clouds import checked
from industnerf.metrics.ground import DISTANCE, SQUARED, Ground
from industnerf.metrics.plan import Plan, refine
from industnerf.metrics.prices import highest, settle
from industnerf.metrics.pricing import cheaper_pairs
from industnerf.metrics.proof import ABSOLUTE_GAP, Emd, allowed_gap, proven, transport_cost

DENSE_PAIRS = 2**17  # so few pairs are solved all at once, in about 20 ms
DENSE_SIDE = 256  # so few points on one side as well
MAX_PIVOTS = 10**9  # a stop for a simplex gone astray: 8192 points take about 10**6
MAX_ROUNDS = 30  # 2 to 6 are usual
ROUND_GROWTH = 4  # pairs that may join in one round, per point
BLOCK = 1024  # rows of the dense problem priced at a time

Cost = Float64[np.ndarray, "n m"] | sparse.coo_array


def emd(a: Float[np.ndarray, "n 3"], b: Float[np.ndarray, "m 3"]) -> float:
    """Least mean distance, in the clouds' unit, over which `a` is carried onto `b`.

    Points of `a` weigh 1/n, of `b` 1/m.  Not squared, not scaled.  At most 1e-9 above the truth
    (or 2e-12 of the longest side of the box around both clouds); raises MetricError rather than
    return anything else.
    """
    return proven_emd(a, b).value


def squared_emd(a: Float[np.ndarray, "n 3"], b: Float[np.ndarray, "m 3"]) -> float:
    """The other reading of "EMD", W2 squared: the least mean squared distance, in squared units.

    Another plan than that of `emd` may be the cheapest.  At most 1e-9 above the truth (or 4e-12 of
    the square of the longest side); raises MetricError rather than return anything else.
    """
    return proven_emd(a, b, SQUARED).value


def proven_emd(
    a: Float[np.ndarray, "n 3"],
    b: Float[np.ndarray, "m 3"],
    ground: Ground = DISTANCE,
    *,
    max_pivots: int = MAX_PIVOTS,
    max_rounds: int = MAX_ROUNDS,
) -> Emd:
    """`emd`, or what `ground` says, with its proof.  `max_rounds=0` solves the dense problem."""
    left, right, unit = weighted(checked(a, "a"), checked(b, "b"))
    found, cost = None, ground.of_unit(unit)
    if max_rounds > 0 and not _is_small(left, right):
        found = _sparse_emd(left, right, ground, max_pivots, max_rounds)
    found = found or _dense_emd(left, right, ground, max_pivots)
    return replace(found, value=found.value * cost, gap=found.gap * cost)


def _sparse_emd(a: Cloud, b: Cloud, ground: Ground, max_pivots: int, max_rounds: int) -> Emd | None:
    """The proven cost from few pairs, or None if they do not yield it."""
    try:
        cells, plan, keys = _start(a, b, ground, max_pivots)
        for rounds in range(1, max_rounds + 1):
            plan = _solve_pairs(a, b, ground, keys, (plan.u, plan.v), max_pivots)
            value = transport_cost(a, b, plan, ground)
            if value <= ABSOLUTE_GAP:  # proven without prices
                return proven(a, b, plan, ground, -math.inf, rounds, len(keys))
            least = -allowed_gap(value) / 10
            rows, cols, reduced = cheaper_pairs(
                a.points, b.points, cells, (plan.u, plan.v), least, ground
            )
            if not len(rows):
                return proven(a, b, plan, ground, least, rounds, len(keys))
            keys = _joined(keys, rows * len(b.mass) + cols, reduced, len(a.mass) + len(b.mass))
    except MetricError:
        return None
    return None


def _dense_emd(a: Cloud, b: Cloud, ground: Ground, max_pivots: int) -> Emd:
    """The proven cost from all pairs at once."""
    plan = _solve_all(a, b, ground, max_pivots)
    undercut = [
        (ground.table(a.points[rows], b.points) - plan.u[rows, None] - plan.v).min()
        for rows in np.array_split(np.arange(len(a.mass)), -(-len(a.mass) // BLOCK))
    ]
    least = min(0.0, float(min(undercut)))
    return proven(a, b, plan, ground, least, 0, len(a.mass) * len(b.mass))


def _start(
    a: Cloud, b: Cloud, ground: Ground, max_pivots: int
) -> tuple[tuple[Cells, Cells], Plan, Int64[np.ndarray, "k"]]:
    """Cells, first prices and first candidate pairs, from a solution of the coarser problem."""
    cells = divide(a), divide(b)
    coarse = _rough(cells[0].coarse, cells[1].coarse, ground, max_pivots)
    plan, rows, cols = refine(a, b, cells, coarse, ground)
    return cells, plan, _distinct(rows * len(b.mass) + cols)


def _rough(a: Cloud, b: Cloud, ground: Ground, max_pivots: int) -> Plan:
    """A plan that is optimal among its candidates, and not held against other pairs."""
    if _is_small(a, b):
        return _solve_all(a, b, ground, max_pivots)
    _, plan, keys = _start(a, b, ground, max_pivots)
    return _solve_pairs(a, b, ground, keys, (plan.u, plan.v), max_pivots)


def _is_small(a: Cloud, b: Cloud) -> bool:
    n, m = len(a.mass), len(b.mass)
    return n * m <= DENSE_PAIRS or min(n, m) <= DENSE_SIDE


def _joined(
    keys: Int64[np.ndarray, "k"],
    found: Int64[np.ndarray, "f"],
    reduced: Float64[np.ndarray, "f"],
    points: int,
) -> Int64[np.ndarray, "j"]:
    """`keys` and the cheapest of the pairs found."""
    if len(found) > ROUND_GROWTH * points:
        found = found[np.argpartition(reduced, ROUND_GROWTH * points)[: ROUND_GROWTH * points]]
    return _distinct(np.concatenate([keys, found]))


def _distinct(keys: Int64[np.ndarray, "k"]) -> Int64[np.ndarray, "d"]:
    """np.unique, which hashes and is some 20 times slower than numpy's sort."""
    keys = np.sort(keys)
    return keys[np.diff(keys, prepend=-1) > 0]


def _solve_pairs(
    a: Cloud,
    b: Cloud,
    ground: Ground,
    keys: Int64[np.ndarray, "k"],
    prices: tuple[Float64[np.ndarray, "n"], Float64[np.ndarray, "m"]],
    max_pivots: int,
) -> Plan:
    """The best plan on the pairs (i, j) = divmod(key, m), from `prices` near the optimal ones."""
    rows, cols = np.divmod(keys, len(b.mass))
    cost = ground.each(a.points[rows], b.points[cols])
    reduced = cost - prices[0][rows] - prices[1][cols]
    shape = (len(a.mass), len(b.mass))
    # Not below 0: POT weighs "infeasible" against the largest cost, not the most negative.
    table = sparse.coo_array((reduced - reduced.min(), (rows, cols)), shape)
    flow, v = _pot(a, b, table, max_pivots)
    used = flow.row.astype(np.int64), flow.col.astype(np.int64)
    u = highest(reduced - v[cols], rows)
    u, v = settle((rows, cols), reduced, used, (u, v))
    return Plan(*used, flow.data, prices[0] + u, prices[1] + v)


def _solve_all(a: Cloud, b: Cloud, ground: Ground, max_pivots: int) -> Plan:
    """The best plan of the dense problem, with prices as high as all pairs allow."""
    cost = ground.table(a.points, b.points)
    flow, v = _pot(a, b, cost, max_pivots)
    rows, cols = np.nonzero(flow)
    cost -= v
    u = cost.min(axis=1)
    cost -= u[:, None]
    return Plan(rows, cols, flow[rows, cols], u, v + cost.min(axis=0))


def _pot(a: Cloud, b: Cloud, cost: Cost, max_pivots: int) -> tuple[Cost, Float64[np.ndarray, "m"]]:
    """POT's network simplex on a dense or sparse cost >= 0: the flow and the prices of `b`.

    The prices of `a` follow from these.  POT's own hang on arcs (n + m) (max cost + 1) dear,
    and carry the rounding of those; scaling the cost up makes that 1 vanish.
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
