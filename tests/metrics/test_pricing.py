"""Pricing and candidates against the slow, obvious versions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

from industnerf.metrics.cells import CELL_SIZE, Cloud, divide
from industnerf.metrics.ground import DISTANCE, SQUARED
from industnerf.metrics.plan import Plan, refine
from industnerf.metrics.pricing import cheaper_pairs

SEEDS, SIZES = st.integers(0, 10**6), st.integers(1, 90)
METRICS = {DISTANCE: "euclidean", SQUARED: "sqeuclidean"}
GROUNDS = st.sampled_from(list(METRICS))


def cloud(seed: int, n: int, mass: float = 1.0) -> Cloud:
    """Points in and out of clumps, within [-1/2, 1/2]; every fourth a repetition."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-0.5, 0.5, (n, 3)) ** rng.integers(1, 4)
    points[3::4] = points[: len(points[3::4])]
    return Cloud(points, np.full(n, mass))


@given(SEEDS, SIZES)
def test_cells_divide_the_cloud(seed, n):
    a = cloud(seed, n)
    cells = divide(a)
    np.testing.assert_array_equal(np.sort(cells.members[cells.members >= 0]), np.arange(n))
    np.testing.assert_array_equal(cells.order, cells.members[cells.members >= 0])
    assert cells.members.shape[1] <= CELL_SIZE
    assert cells.coarse.mass.sum() == n
    for members, centre, radius in zip(
        cells.members, cells.coarse.points, cells.radius, strict=True
    ):
        inside = a.points[members[members >= 0]]
        # A mean of four: 4 eps.
        np.testing.assert_allclose(inside.mean(axis=0), centre, rtol=0, atol=1e-15)
        assert np.linalg.norm(inside - centre, axis=1).max() == pytest.approx(radius, abs=1e-15)


@given(SEEDS, SIZES, SIZES, st.sampled_from([-0.3, -1e-3, 0.0, 1e-3, 0.3]), GROUNDS)
def test_no_cheaper_pair_is_overlooked(seed, n, m, limit, ground):
    """With wild prices and with near-optimal ones, the pairs found are those of the full table."""
    a, b, rng = cloud(seed, n).points, cloud(seed + 1, m).points, np.random.default_rng(seed)
    cells = divide(Cloud(a, np.ones(n))), divide(Cloud(b, np.ones(m)))
    wild = rng.normal(size=n), rng.normal(size=m)
    # Feasible: no length is below its projection, no square below that less 1/4.
    way, less = [0.6, 0.8, 0.0], 1 / 8 if ground.squared else 0.0
    tight = a @ way - less, -b @ way - less
    for u, v in (wild, tight):
        table = cdist(a, b, METRICS[ground]) - u[:, None] - v
        rows, cols, reduced = cheaper_pairs(a, b, cells, (u, v), limit, ground)
        # The two tables round differently, by some eps of lengths and prices of about 1.
        np.testing.assert_allclose(reduced, table[rows, cols], rtol=0, atol=1e-14)
        found = np.zeros(table.shape, bool)
        found[rows, cols] = True
        assert found.sum() == len(rows)  # none twice
        assert found[table < limit - 1e-14].all()
        assert not found[table > limit + 1e-14].any()


@given(SEEDS, SIZES, GROUNDS)
def test_cells_that_overlap_rule_out_no_pair(seed, n, ground):
    """Of a cloud and itself every point and itself are a pair at cost 0, however wide the cells."""
    a = cloud(seed, n)
    cells, free = divide(a), np.zeros(n)
    rows, cols, _ = cheaper_pairs(a.points, a.points, (cells, cells), (free, free), 1e-9, ground)
    assert {(i, i) for i in range(n)} <= set(zip(rows.tolist(), cols.tolist(), strict=True))


@given(SEEDS, st.integers(30, 90), st.integers(30, 90), GROUNDS)
def test_a_spread_plan_carries_all_mass(seed, n, m, ground):
    """Any coarse plan, however bad, becomes a plan between the points, within its cells."""
    a, b = cloud(seed, n, float(m)), cloud(seed + 1, m, float(n))
    cells = divide(a), divide(b)
    coarse = in_turn(cells[0].coarse, cells[1].coarse)
    plan, rows, cols = refine(a, b, cells, coarse, ground)
    assert (plan.flow > 0).all()
    np.testing.assert_array_equal(np.bincount(plan.rows, plan.flow), a.mass)
    np.testing.assert_array_equal(np.bincount(plan.cols, plan.flow), b.mass)
    used = set(zip(cell_of(cells[0])[plan.rows], cell_of(cells[1])[plan.cols], strict=True))
    assert used <= set(zip(coarse.rows, coarse.cols, strict=True))
    assert set(zip(plan.rows, plan.cols, strict=True)) <= set(zip(rows, cols, strict=True))


def in_turn(a: Cloud, b: Cloud) -> Plan:
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
    return Plan(np.array(rows), np.array(cols), np.array(flow), *zero)


def cell_of(cells) -> np.ndarray:
    owner = np.empty(len(cells.order), int)
    for number, members in enumerate(cells.members):
        owner[members[members >= 0]] = number
    return owner
