"""Earth mover's distance, exact and proven: W1, Euclidean ground cost, equal weights.

The solver is POT's network simplex.  It is given few of the n x m pairs and the plan it finds is
optimal among those; its prices are then held against ALL pairs (`pricing`), the cheaper ones
join, and it solves again, until none is left:

    value = sum_k flow_k |a_i - b_j|   >=   W1   >=   sum_i u_i + sum_j v_j + (least reduced cost)

The distance of the two ends is `gap`: a value with a larger gap than allowed is never returned.
Where the sparse way does not get there the dense problem is solved, and proven the same way.

POT's `potentials_init` serves dense problems only.  A sparse one is warmed by handing it
reduced costs, which differ from the costs by a constant and start the simplex near its end.
Inside, lengths are in units of the clouds' extent (see `_to_unit`), and masses are whole
numbers, so that POT's flows are exact and the marginals hold without a tolerance.
"""

import math
import os
import warnings
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float64, Int64
from scipy import sparse
from scipy.spatial.distance import cdist

from industnerf.errors import MetricError
from industnerf.metrics.candidates import Plan, refine
from industnerf.metrics.cells import Cells, Cloud, divide
from industnerf.metrics.clouds import checked
from industnerf.metrics.pricing import cheaper_pairs

RELATIVE_GAP = 1e-9  # of the value
ABSOLUTE_GAP = 1e-12  # of the longest side around both: rounding, when they all but coincide
DENSE_PAIRS = 2**17  # so few pairs are solved all at once, in about 20 ms
DENSE_SIDE = 256  # so few points on one side as well: few pairs per point of the other
MAX_PIVOTS = 10**9  # a stop for a simplex gone astray: 8192 points take about 10**6
MAX_ROUNDS = 30  # 3 to 8 are usual
ROUND_GROWTH = 4  # pairs that may join in one round, per point
BLOCK = 1024  # rows of the dense problem priced at a time

Cost = Float64[np.ndarray, "n m"] | sparse.coo_array


@dataclass(frozen=True)
class Emd:
    """A proven distance: the truth lies in [value - gap, value], in the clouds' unit."""

    value: float
    gap: float
    rounds: int  # of sparse solves; 0: the dense problem was solved
    pairs: int  # given to the solver in the last round


def emd(a: Float[np.ndarray, "n 3"], b: Float[np.ndarray, "m 3"]) -> float:
    """Least mean distance, in the clouds' unit, over which `a` is carried onto `b`.

    Points of `a` weigh 1/n, of `b` 1/m.  Not squared, not scaled.  Within 1e-9 of the truth
    (or 1e-12 of the longest side around both); raises MetricError rather than return anything
    else.
    """
    return proven_emd(a, b).value


def proven_emd(
    a: Float[np.ndarray, "n 3"],
    b: Float[np.ndarray, "m 3"],
    *,
    max_pivots: int = MAX_PIVOTS,
    max_rounds: int = MAX_ROUNDS,
) -> Emd:
    """`emd` with its proof.  `max_rounds=0` solves the dense problem."""
    left, right, unit = _to_unit(checked(a, "a"), checked(b, "b"))
    if unit == 0:  # all points are one point
        return Emd(0.0, 0.0, 0, 0)
    found = None
    if max_rounds > 0 and not _is_small(left, right):
        found = _sparse_emd(left, right, max_pivots, max_rounds)
    found = found or _dense_emd(left, right, max_pivots)
    return Emd(found.value * unit, found.gap * unit, found.rounds, found.pairs)


def _to_unit(
    a: Float64[np.ndarray, "n 3"], b: Float64[np.ndarray, "m 3"]
) -> tuple[Cloud, Cloud, float]:
    """Both clouds about the origin, with extent in [1/2, 1), their masses, and the unit taken out.

    The unit is a power of two, so scaling is exact.
    """
    low, high = np.minimum(a.min(axis=0), b.min(axis=0)), np.maximum(a.max(axis=0), b.max(axis=0))
    with np.errstate(over="ignore"):
        centre, extent = low / 2 + high / 2, float(np.max(high - low))
    if not math.isfinite(extent):
        raise MetricError(f"the clouds extend from {low} to {high}: too far for float64")
    unit = math.ldexp(1.0, math.frexp(extent)[1]) if extent else 0.0
    shared = math.gcd(len(a), len(b))
    mass_a, mass_b = float(len(b) // shared), float(len(a) // shared)
    left = Cloud((a - centre) / (unit or 1.0), np.full(len(a), mass_a))
    right = Cloud((b - centre) / (unit or 1.0), np.full(len(b), mass_b))
    return left, right, unit


def _sparse_emd(a: Cloud, b: Cloud, max_pivots: int, max_rounds: int) -> Emd | None:
    """The proven distance from few pairs, or None if they do not yield it."""
    try:
        cells, plan, keys = _start(a, b, max_pivots)
        for rounds in range(1, max_rounds + 1):
            plan = _solve_pairs(a, b, keys, (plan.u, plan.v), max_pivots)
            value = _cost(a, b, plan)
            if value <= ABSOLUTE_GAP:  # no distance is below 0: that bound does, prices or none
                return _proven(a, b, plan, value, -math.inf, rounds, len(keys))
            limit = -max(RELATIVE_GAP * value, ABSOLUTE_GAP) / 10
            rows, cols, reduced = cheaper_pairs(a.points, b.points, cells, (plan.u, plan.v), limit)
            if not len(rows):
                return _proven(a, b, plan, value, limit, rounds, len(keys))
            keys = _joined(keys, rows * len(b.points) + cols, reduced, len(a.mass) + len(b.mass))
    except MetricError:
        return None
    return None


def _dense_emd(a: Cloud, b: Cloud, max_pivots: int) -> Emd:
    """The proven distance from all pairs at once; its memory is some 40 bytes a pair."""
    plan = _solve_all(a, b, max_pivots)
    least = min(
        float((cdist(a.points[rows], b.points) - plan.u[rows, None] - plan.v).min())
        for rows in np.array_split(np.arange(len(a.mass)), -(-len(a.mass) // BLOCK))
    )
    return _proven(a, b, plan, _cost(a, b, plan), min(least, 0.0), 0, len(a.mass) * len(b.mass))


def _start(
    a: Cloud, b: Cloud, max_pivots: int
) -> tuple[tuple[Cells, Cells], Plan, Int64[np.ndarray, "k"]]:
    """Cells, first prices and first candidate pairs, from a solution of the coarser problem."""
    cells = divide(a), divide(b)
    coarse = _rough(cells[0].coarse, cells[1].coarse, max_pivots)
    plan, rows, cols = refine(a, b, cells, coarse)
    return cells, plan, np.unique(rows * len(b.points) + cols)


def _rough(a: Cloud, b: Cloud, max_pivots: int) -> Plan:
    """A plan that is optimal among its candidates, and not held against other pairs."""
    if _is_small(a, b):
        return _solve_all(a, b, max_pivots)
    _, plan, keys = _start(a, b, max_pivots)
    return _solve_pairs(a, b, keys, (plan.u, plan.v), max_pivots)


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
    return np.unique(np.concatenate([keys, found]))


def _cost(a: Cloud, b: Cloud, plan: Plan) -> float:
    """Mean distance of a plan that carries exactly the mass of every point, or MetricError."""
    sent = np.bincount(plan.rows, plan.flow, minlength=len(a.mass))
    received = np.bincount(plan.cols, plan.flow, minlength=len(b.mass))
    if not (np.array_equal(sent, a.mass) and np.array_equal(received, b.mass)):
        off = np.abs(sent - a.mass).sum() + np.abs(received - b.mass).sum()
        raise MetricError(f"POT's plan misplaces {off:g} of a mass of {a.mass.sum():g}")
    lengths = np.linalg.norm(a.points[plan.rows] - b.points[plan.cols], axis=1)
    return float(plan.flow @ lengths / a.mass.sum())


def _proven(
    a: Cloud, b: Cloud, plan: Plan, value: float, least: float, rounds: int, pairs: int
) -> Emd:
    """`value`, if no pair's reduced cost is below `least` and that bounds it closely enough."""
    bound = float(a.mass @ plan.u + b.mass @ plan.v) / a.mass.sum() + least
    gap = value - max(bound, 0.0)
    if not gap <= max(RELATIVE_GAP * value, ABSOLUTE_GAP):
        raise MetricError(
            f"EMD of {len(a.mass)} and {len(b.mass)} points is not proven: the plan found costs "
            f"{value:.17g} of the clouds' extent, but the prices only prove {bound:.17g}"
        )
    return Emd(value, float(max(gap, 0.0)), rounds, pairs)


def _solve_pairs(
    a: Cloud,
    b: Cloud,
    keys: Int64[np.ndarray, "k"],
    prices: tuple[Float64[np.ndarray, "n"], Float64[np.ndarray, "m"]],
    max_pivots: int,
) -> Plan:
    """The best plan on the pairs (i, j) = divmod(key, m), from `prices` near the optimal ones."""
    rows, cols = np.divmod(keys, len(b.mass))
    cost = np.linalg.norm(a.points[rows] - b.points[cols], axis=1)
    reduced = cost - prices[0][rows] - prices[1][cols]
    shape = (len(a.mass), len(b.mass))
    flow, _, v = _pot(a, b, sparse.coo_array((reduced, (rows, cols)), shape), max_pivots)
    # POT's prices hang on arcs n + m times dearer than any pair and carry their rounding.
    # Two passes of "as high as the pairs allow" mend what that breaks.
    v = v + prices[1]
    u = _highest(cost - v[cols], rows)
    by_col = np.argsort(cols, kind="stable")
    v = _highest((cost - u[rows])[by_col], cols[by_col])
    return Plan(flow.row.astype(np.int64), flow.col.astype(np.int64), flow.data, u, v)


def _highest(
    room: Float64[np.ndarray, "k"], owner: Int64[np.ndarray, "k"]
) -> Float64[np.ndarray, "n"]:
    """The least `room` of each owner; `owner` ascends and every one has a pair."""
    return np.minimum.reduceat(room, np.flatnonzero(np.diff(owner, prepend=-1)))


def _solve_all(a: Cloud, b: Cloud, max_pivots: int) -> Plan:
    """The best plan of the dense problem, with prices that no pair undercuts."""
    cost = cdist(a.points, b.points)
    flow, _, v = _pot(a, b, cost, max_pivots)
    rows, cols = np.nonzero(flow)
    cost -= v
    u = cost.min(axis=1)
    cost -= u[:, None]
    return Plan(rows, cols, flow[rows, cols], u, v + cost.min(axis=0))


def _pot(
    a: Cloud, b: Cloud, cost: Cost, max_pivots: int
) -> tuple[Cost, Float64[np.ndarray, "n"], Float64[np.ndarray, "m"]]:
    """POT's network simplex on a dense or sparse cost: flow and prices, or MetricError."""
    for backend in ("PYTORCH", "JAX", "CUPY", "TENSORFLOW"):  # numpy is enough, and loads fast
        os.environ.setdefault(f"POT_BACKEND_DISABLE_{backend}", "1")
    import ot

    # POT adds 1 to the largest cost before it multiplies by n + m: make that 1 vanish.
    largest = np.abs(cost.data if sparse.issparse(cost) else cost).max()
    scale = math.ldexp(1.0, 20 - math.frexp(max(largest, 1e-9))[1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # POT's verdict is in the log
        flow, log = ot.emd(a.mass, b.mass, cost * scale, numItermax=max_pivots, log=True)
    if log["warning"]:
        raise MetricError(
            f"POT did not solve the transport of {len(a.mass)} to {len(b.mass)} points within "
            f"max_pivots={max_pivots}: {log['warning']}"
        )
    return flow, log["u"] / scale, log["v"] / scale
