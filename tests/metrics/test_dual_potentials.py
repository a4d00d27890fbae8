"""Settled prices: still optimal on the pairs, and as near to zero as such prices can be."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment, linprog

from industnerf.metrics.dual_potentials import center_potentials, row_minimum


def problem(seed: int, n: int):
    """A small assignment, its best plan, and the costs reduced by optimal but extreme prices."""
    rng = np.random.default_rng(seed)
    cost = rng.integers(-8, 24, (n, n)) / 8  # multiples of 1/8: sums are exact, ties are many
    support = linear_sum_assignment(cost)
    rows, cols = np.divmod(np.arange(n * n), n)
    return cost, (rows, cols), support


def optimal_potentials(cost: np.ndarray, support, objective: np.ndarray, bounds) -> np.ndarray:
    """By linear programming: u_i + v_j <= cost_ij, equal where used."""
    n = len(cost)
    rows, cols = np.divmod(np.arange(n * n), n)
    pairs = np.zeros((n * n, 2 * n))
    pairs[np.arange(n * n), rows] = pairs[np.arange(n * n), n + cols] = 1
    tight = support[0] * n + support[1]
    solution = linprog(objective, pairs, cost.ravel(), pairs[tight], cost.ravel()[tight], bounds)
    assert solution.status == 0
    return solution.x


@given(st.integers(0, 10**6), st.integers(2, 8))
def test_settled_prices_are_the_nearest_optimal_ones(seed, n):
    cost, pairs, support = problem(seed, n)
    extreme_potentials = optimal_potentials(
        cost, support, np.random.default_rng(seed).normal(size=2 * n), [(-9, 9)] * 2 * n
    )
    u, v = center_potentials(
        pairs, cost.ravel(), support, (extreme_potentials[:n], extreme_potentials[n:])
    )
    # linprog is good to about 1e-9 at values below 10.
    assert (u[:, None] + v <= cost + 1e-8).all()
    np.testing.assert_allclose((u[:, None] + v)[support], cost[support], rtol=0, atol=1e-8)
    assert u.max() <= 1e-8
    assert v.min() >= -1e-8
    # Nearest: of all optimal u <= 0 <= v, the least sum of v - u.
    bounds = [(None, 0)] * n + [(0, None)] * n
    best = optimal_potentials(cost, support, np.repeat([-1.0, 1.0], n), bounds)
    np.testing.assert_allclose(np.r_[u, v], best, rtol=0, atol=1e-7)


def test_zero_prices_that_are_optimal_stay():
    cost, support = np.array([[0.0, 1.0], [2.0, 0.0]]), (np.array([0, 1]), np.array([0, 1]))
    extreme_potentials = np.array([1.0, 0.0]), np.array([-1.0, 0.0])
    pairs = np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1])
    u, v = center_potentials(pairs, cost.ravel(), support, extreme_potentials)
    np.testing.assert_array_equal(np.r_[u, v], 0)


def test_highest_is_the_least_room_of_each_owner():
    slack, rows = np.array([3.0, 1.0, 2.0, 5.0]), np.array([0, 0, 1, 1])
    np.testing.assert_array_equal(row_minimum(slack, rows), [1, 2])
