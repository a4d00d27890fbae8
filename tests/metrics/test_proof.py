"""The proof accepts an optimal plan with its prices, and nothing that is a little worse."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from industnerf.errors import MetricError
from industnerf.metrics.cells import Cloud
from industnerf.metrics.ground import DISTANCE, SQUARED
from industnerf.metrics.plan import Plan
from industnerf.metrics.proof import proven, transport_cost

# On a line, a_i = i and b_i = i + 1/4: each point goes 1/4 to the right, and u = -x, v = x prove
# it, since |x - y| >= y - x.  All these numbers are exact in binary.
A = Cloud(np.arange(10.0)[:, None] * np.array([1.0, 0, 0]) / 16, np.ones(10))
B = Cloud(A.points + np.array([1 / 64, 0, 0]), np.ones(10))
EACH = np.arange(10)
PLAN = Plan(EACH, EACH, np.ones(10), -A.points[:, 0], B.points[:, 0])


def test_the_best_plan_is_proven_to_the_last_digit():
    found = proven(A, B, PLAN, DISTANCE, 0.0, 3, 100)
    assert (found.value, found.gap, found.rounds, found.pairs) == (1 / 64, 0.0, 3, 100)


@pytest.mark.parametrize("share", [1e-8, 1e-2])
def test_prices_too_low_prove_nothing(share):
    low = replace(PLAN, u=PLAN.u - share / 64)
    with pytest.raises(MetricError, match=r"costs 0.015625, .* only prove 0.015"):
        proven(A, B, low, DISTANCE, 0.0, 0, 100)


def test_undercut_prices_prove_nothing():
    with pytest.raises(MetricError, match="not proven"):
        proven(A, B, PLAN, DISTANCE, -1e-8 / 64, 0, 100)


def test_a_little_is_allowed_and_reported():
    # 1e-10 of the value is a tenth of what is allowed; the sums' rounding is a few eps.
    found = proven(A, B, PLAN, DISTANCE, -1e-10 / 64, 0, 100)
    assert found.gap == pytest.approx(1e-10 / 64, abs=1e-16)


def test_a_dearer_plan_is_not_proven():
    """Two neighbours swap: 9/64 and -7/64 in place of 1/64 twice, in length 1/8 more in all."""
    swapped = replace(PLAN, cols=np.array([1, 0, *range(2, 10)]))
    mean_length = cdist(A.points, B.points)[EACH, swapped.cols].mean()
    assert transport_cost(A, B, swapped, DISTANCE) == pytest.approx(mean_length, rel=1e-14)
    with pytest.raises(MetricError, match="not proven"):
        proven(A, B, swapped, DISTANCE, 0.0, 0, 100)


def test_undefined_prices_prove_nothing():
    with pytest.raises(MetricError, match="not proven"):
        proven(A, B, replace(PLAN, u=PLAN.u * np.nan), DISTANCE, 0.0, 0, 100)


@pytest.mark.parametrize("flow", [np.full(10, 0.9), np.full(10, 1 + 1e-12), np.zeros(10)])
def test_a_plan_that_misplaces_mass_has_no_cost(flow):
    with pytest.raises(MetricError, match="misplaces"):
        transport_cost(A, B, replace(PLAN, flow=flow), DISTANCE)


def test_a_plan_that_takes_from_the_wrong_points_has_no_cost():
    with pytest.raises(MetricError, match="misplaces 18"):
        transport_cost(A, B, replace(PLAN, rows=np.zeros(10, np.int64)), DISTANCE)
    with pytest.raises(MetricError, match="misplaces 18"):
        transport_cost(A, B, replace(PLAN, cols=np.zeros(10, np.int64)), DISTANCE)


def test_a_trace_of_mass_in_the_wrong_place_is_noticed():
    """2^-40 of the first point's mass goes to the second: all of it is sent, not all received."""
    trace = 2.0**-40
    leak = replace(
        PLAN,
        rows=np.array([*EACH, 0]),
        cols=np.array([*EACH, 1]),
        flow=np.array([1 - trace, *np.ones(9), trace]),
    )
    with pytest.raises(MetricError, match="misplaces"):
        transport_cost(A, B, leak, DISTANCE)


def test_a_plan_that_leaves_a_point_out_has_no_cost():
    lost = replace(PLAN, rows=EACH[1:], cols=EACH[1:], flow=np.ones(9))
    with pytest.raises(MetricError, match="misplaces 2 of a mass of 10"):
        transport_cost(A, B, lost, DISTANCE)


@pytest.mark.parametrize(("ground", "metric"), [(DISTANCE, "euclidean"), (SQUARED, "sqeuclidean")])
def test_a_shuffle_is_as_dear_as_the_hungarian_method_says(ground, metric):
    rng = np.random.default_rng(0)
    a, b = (Cloud(rng.uniform(-0.5, 0.5, (30, 3)), np.ones(30)) for _ in range(2))
    cost = cdist(a.points, b.points, metric)
    rows, cols = linear_sum_assignment(cost)
    plan = Plan(rows, cols, np.ones(30), np.zeros(30), np.zeros(30))
    # The same thirty costs, summed in another order.
    assert transport_cost(a, b, plan, ground) == pytest.approx(cost[rows, cols].mean(), rel=1e-14)
