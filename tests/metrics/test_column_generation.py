"""Pricing and candidates against the slow, obvious versions."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

from industnerf.metrics.cells import CELL_SIZE, WeightedCloud, kd_cells
from industnerf.metrics.column_generation import violated_pairs
from industnerf.metrics.ground_cost import EUCLIDEAN, SQUARED_EUCLIDEAN, GroundCost
from industnerf.metrics.transport_plan import TransportPlan, refine_plan

SEEDS, SIZES = st.integers(0, 10**6), st.integers(1, 90)
METRICS = {EUCLIDEAN: "euclidean", SQUARED_EUCLIDEAN: "sqeuclidean"}
GROUND_COSTS = st.sampled_from(list(METRICS))


def cloud(seed: int, n: int, mass: float = 1.0) -> WeightedCloud:
    """Points in and out of clumps, within [-1/2, 1/2]; every fourth a repetition."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-0.5, 0.5, (n, 3)) ** rng.integers(1, 4)
    points[3::4] = points[: len(points[3::4])]
    return WeightedCloud(points, np.full(n, mass))


@given(SEEDS, SIZES)
def test_cells_divide_the_cloud(seed, n):
    a = cloud(seed, n)
    cells = kd_cells(a)
    np.testing.assert_array_equal(np.sort(cells.members[cells.members >= 0]), np.arange(n))
    np.testing.assert_array_equal(cells.order, cells.members[cells.members >= 0])
    assert cells.members.shape[1] <= CELL_SIZE
    assert cells.coarse.mass.sum() == n
    for members, center in zip(cells.members, cells.coarse.points, strict=True):
        inside = a.points[members[members >= 0]]
        # A mean of four: 4 eps.
        np.testing.assert_allclose(inside.mean(axis=0), center, rtol=0, atol=1e-15)


@given(SEEDS, SIZES, SIZES, st.sampled_from([-0.3, -1e-3, 0.0, 1e-3, 0.3]), GROUND_COSTS)
def test_no_cheaper_pair_is_overlooked(seed, n, m, limit, ground):
    """With wild prices and with near-optimal ones, the pairs found are those of the full table."""
    a, b, rng = cloud(seed, n).points, cloud(seed + 1, m).points, np.random.default_rng(seed)
    cells = kd_cells(WeightedCloud(a, np.ones(n))), kd_cells(WeightedCloud(b, np.ones(m)))
    noise = rng.normal(size=n), rng.normal(size=m)
    # Feasible: no length is below its projection, no square below that less 1/4.
    offset, lowering = [0.6, 0.8, 0.0], 1 / 8 if ground.squared else 0.0
    tight = a @ offset - lowering, -b @ offset - lowering
    for u, v in (noise, tight):
        reduced_costs = cdist(a, b, METRICS[ground]) - u[:, None] - v
        rows, cols, reduced = violated_pairs(a, b, cells, (u, v), limit, ground)
        # The two tables round differently, by some eps of lengths and prices of about 1.
        np.testing.assert_allclose(reduced, reduced_costs[rows, cols], rtol=0, atol=1e-14)
        violations = np.zeros(reduced_costs.shape, bool)
        violations[rows, cols] = True
        assert violations.sum() == len(rows)  # none twice
        assert violations[reduced_costs < limit - 1e-14].all()
        assert not violations[reduced_costs > limit + 1e-14].any()


@given(SEEDS, SIZES, GROUND_COSTS)
def test_cells_that_overlap_rule_out_no_pair(seed, n, ground):
    """Of a cloud and itself every point and itself are a pair at cost 0, however wide the cells."""
    a = cloud(seed, n)
    cells, free = kd_cells(a), np.zeros(n)
    rows, cols, _ = violated_pairs(a.points, a.points, (cells, cells), (free, free), 1e-9, ground)
    assert {(i, i) for i in range(n)} <= set(zip(rows.tolist(), cols.tolist(), strict=True))


@given(SEEDS, GROUND_COSTS)
def test_no_cost_is_below_its_tangent(seed, ground):
    """At any difference, and at none: the slope of a length is not defined there."""
    rng = np.random.default_rng(seed)
    here, there = rng.normal(size=(2, 40, 3))
    here[0] = 0
    cost, slope = ground.tangent(here)
    cost_there, _ = ground.tangent(there)
    np.testing.assert_allclose(cost, ground.rowwise(here, np.zeros_like(here)), rtol=1e-15)
    # 1e-14: rounding of sums of squares of up to about 50.
    assert (cost_there >= cost + ((there - here) * slope).sum(axis=1) - 1e-14).all()


def test_of_far_clouds_few_pairs_are_computed():
    """Potentials that a shift of the cloud makes optimal, as in a plan over far distances."""
    computed = []

    class Counting(GroundCost):
        def between_cells(self, p, q):
            computed.append(len(p) * p.shape[1] * q.shape[1])
            return super().between_cells(p, q)

    a, b = cloud(1, 2000), cloud(2, 2000)
    far = WeightedCloud(b.points + np.array([1.8, 2.4, 0.0]), b.mass)
    along = np.array([-0.6, -0.8, 0.0])
    potentials = a.points @ along, -far.points @ along
    cells = kd_cells(a), kd_cells(far)
    rows, _, _ = violated_pairs(a.points, far.points, cells, potentials, 0.0, Counting(False))
    assert not len(rows)
    assert sum(computed) < 2000 * 2000 / 10


@given(SEEDS, st.integers(30, 90), st.integers(30, 90), GROUND_COSTS)
def test_a_spread_plan_carries_all_mass(seed, n, m, ground):
    """Any coarse plan, however bad, becomes a plan between the points, within its cells."""
    a, b = cloud(seed, n, float(m)), cloud(seed + 1, m, float(n))
    cells = kd_cells(a), kd_cells(b)
    coarse = north_west_corner(cells[0].coarse, cells[1].coarse)
    plan, rows, cols = refine_plan(a, b, cells, coarse, ground)
    assert (plan.flow > 0).all()
    np.testing.assert_array_equal(np.bincount(plan.rows, plan.flow), a.mass)
    np.testing.assert_array_equal(np.bincount(plan.cols, plan.flow), b.mass)
    has_flow = set(
        zip(cell_of_point(cells[0])[plan.rows], cell_of_point(cells[1])[plan.cols], strict=True)
    )
    assert has_flow <= set(zip(coarse.rows, coarse.cols, strict=True))
    assert set(zip(plan.rows, plan.cols, strict=True)) <= set(zip(rows, cols, strict=True))


def north_west_corner(a: WeightedCloud, b: WeightedCloud) -> TransportPlan:
    """A feasible plan that ignores distance: cells served in an arbitrary order."""
    rows, cols, flow = [], [], []
    left, right, i, j = a.mass.copy(), b.mass[::-1].copy(), 0, 0
    while i < len(left) and j < len(right):
        moved = min(left[i], right[j])
        rows, cols, flow = [*rows, i], [*cols, len(right) - 1 - j], [*flow, moved]
        left[i] -= moved
        right[j] -= moved
        i, j = i + (left[i] == 0), j + (right[j] == 0)
    zero = np.zeros(len(left)), np.zeros(len(right))
    return TransportPlan(np.array(rows), np.array(cols), np.array(flow), *zero)


def cell_of_point(cells) -> np.ndarray:
    cell_ids = np.empty(len(cells.order), int)
    for number, members in enumerate(cells.members):
        cell_ids[members[members >= 0]] = number
    return cell_ids
