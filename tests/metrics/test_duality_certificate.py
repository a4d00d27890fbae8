"""The proof accepts an optimal plan with its prices, and nothing that is a little worse."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from industnerf.errors import MetricError
from industnerf.metrics.cells import WeightedCloud
from industnerf.metrics.duality_certificate import certify, transport_cost
from industnerf.metrics.ground_cost import EUCLIDEAN, SQUARED_EUCLIDEAN
from industnerf.metrics.transport_plan import TransportPlan

# On a line, a_i = i and b_i = i + 1/4: each point goes 1/4 to the right, and u = -x, v = x prove
# it, since |x - y| >= y - x.  All these numbers are exact in binary.
A = WeightedCloud(np.arange(10.0)[:, None] * np.array([1.0, 0, 0]) / 16, np.ones(10))
B = WeightedCloud(A.points + np.array([1 / 64, 0, 0]), np.ones(10))
INDICES = np.arange(10)
PLAN = TransportPlan(INDICES, INDICES, np.ones(10), -A.points[:, 0], B.points[:, 0])


def test_the_best_plan_is_proven_to_the_last_digit():
    certified = certify(A, B, PLAN, EUCLIDEAN, 0.0, 3, 100)
    assert (certified.value, certified.gap, certified.rounds, certified.pairs) == (
        1 / 64,
        0.0,
        3,
        100,
    )


@pytest.mark.parametrize("share", [1e-8, 1e-2])
def test_prices_too_low_prove_nothing(share):
    low = replace(PLAN, u=PLAN.u - share / 64)
    with pytest.raises(MetricError, match=r"costs 0.015625, .* only prove 0.015"):
        certify(A, B, low, EUCLIDEAN, 0.0, 0, 100)


def test_undercut_prices_prove_nothing():
    with pytest.raises(MetricError, match="not proven"):
        certify(A, B, PLAN, EUCLIDEAN, -1e-8 / 64, 0, 100)


def test_a_little_is_allowed_and_reported():
    # 1e-10 of the value is a tenth of what is allowed; the sums' rounding is a few eps.
    certified = certify(A, B, PLAN, EUCLIDEAN, -1e-10 / 64, 0, 100)
    assert certified.gap == pytest.approx(1e-10 / 64, abs=1e-16)


def test_a_dearer_plan_is_not_proven():
    """Two neighbors swap: 9/64 and -7/64 in place of 1/64 twice, in length 1/8 more in all."""
    swapped = replace(PLAN, cols=np.array([1, 0, *range(2, 10)]))
    mean_length = cdist(A.points, B.points)[INDICES, swapped.cols].mean()
    assert transport_cost(A, B, swapped, EUCLIDEAN) == pytest.approx(mean_length, rel=1e-14)
    with pytest.raises(MetricError, match="not proven"):
        certify(A, B, swapped, EUCLIDEAN, 0.0, 0, 100)


def test_undefined_prices_prove_nothing():
    with pytest.raises(MetricError, match="not proven"):
        certify(A, B, replace(PLAN, u=PLAN.u * np.nan), EUCLIDEAN, 0.0, 0, 100)


@pytest.mark.parametrize("flow", [np.full(10, 0.9), np.full(10, 1 + 1e-12), np.zeros(10)])
def test_a_plan_that_misplaces_mass_has_no_cost(flow):
    with pytest.raises(MetricError, match="misplaces"):
        transport_cost(A, B, replace(PLAN, flow=flow), EUCLIDEAN)


def test_a_plan_that_takes_from_the_wrong_points_has_no_cost():
    with pytest.raises(MetricError, match="misplaces 18"):
        transport_cost(A, B, replace(PLAN, rows=np.zeros(10, np.int64)), EUCLIDEAN)
    with pytest.raises(MetricError, match="misplaces 18"):
        transport_cost(A, B, replace(PLAN, cols=np.zeros(10, np.int64)), EUCLIDEAN)


def test_a_trace_of_mass_in_the_wrong_place_is_noticed():
    """2^-40 of the first point's mass goes to the second: all of it is sent, not all received."""
    trace = 2.0**-40
    leak = replace(
        PLAN,
        rows=np.array([*INDICES, 0]),
        cols=np.array([*INDICES, 1]),
        flow=np.array([1 - trace, *np.ones(9), trace]),
    )
    with pytest.raises(MetricError, match="misplaces"):
        transport_cost(A, B, leak, EUCLIDEAN)


def test_a_plan_that_leaves_a_point_out_has_no_cost():
    incomplete = replace(PLAN, rows=INDICES[1:], cols=INDICES[1:], flow=np.ones(9))
    with pytest.raises(MetricError, match="misplaces 2 of a mass of 10"):
        transport_cost(A, B, incomplete, EUCLIDEAN)


@pytest.mark.parametrize(
    ("ground", "metric"), [(EUCLIDEAN, "euclidean"), (SQUARED_EUCLIDEAN, "sqeuclidean")]
)
def test_a_shuffle_is_as_dear_as_the_hungarian_method_says(ground, metric):
    rng = np.random.default_rng(0)
    a, b = (WeightedCloud(rng.uniform(-0.5, 0.5, (30, 3)), np.ones(30)) for _ in range(2))
    cost = cdist(a.points, b.points, metric)
    rows, cols = linear_sum_assignment(cost)
    plan = TransportPlan(rows, cols, np.ones(30), np.zeros(30), np.zeros(30))
    # The same thirty costs, summed in another order.
    assert transport_cost(a, b, plan, ground) == pytest.approx(cost[rows, cols].mean(), rel=1e-14)
