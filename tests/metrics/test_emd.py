"""Closed forms, an independent solver, the axioms of a metric, and all ways to fail.

Below `DENSE_PAIRS` pairs the dense problem is solved, above it the sparse ones; `LARGE` is above.
"""

import math
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment
from scipy.sparse import coo_array, issparse
from scipy.spatial.distance import cdist

from industnerf.errors import MetricError
from industnerf.metrics import emd as module
from industnerf.metrics.cells import normalize_clouds
from industnerf.metrics.duality_certificate import CertifiedEmd
from industnerf.metrics.emd import DENSE_PAIRS, DENSE_POINTS, certified_emd, emd
from industnerf.metrics.ground_cost import EUCLIDEAN, SQUARED_EUCLIDEAN, GroundCost
from industnerf.metrics.transport_plan import TransportPlan

LARGE = 600
SEEDS = st.integers(0, 10**6)
SIZES = st.one_of(st.integers(1, 40), st.integers(370, 420))


def ball(seed: int, n: int) -> np.ndarray:
    """Points on a sphere of diameter 1."""
    directions = np.random.default_rng(seed).normal(size=(n, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True) / 2


def moved(cloud: np.ndarray, *shift: float) -> np.ndarray:
    return cloud + np.array(shift)


def box(seed: int, n: int) -> np.ndarray:
    """Points on the six faces of a 1 x 0.5 x 0.25 box."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-0.5, 0.5, (n, 3))
    points[np.arange(n), rng.integers(3, size=n)] = rng.choice([-0.5, 0.5], n)
    return points * [1, 0.5, 0.25]


def half_box(seed: int, n: int) -> np.ndarray:
    """The same box where x < 0."""
    points = box(seed, 4 * n)
    return points[points[:, 0] < 0][:n]


def value(a: np.ndarray, b: np.ndarray) -> float:
    return emd(a, b).value


def assert_certified(result: CertifiedEmd, truth: float, min_gap: float = 0.0) -> None:
    """`result` is the truth or at most 1e-9 or `min_gap` more, and its interval holds it.

    1e-13 for the truth's own rounding, a sum of up to some thousand lengths.
    """
    allowed = max(1e-9 * truth, min_gap)
    assert result.value >= truth * (1 - 1e-13)
    assert result.value <= truth + allowed
    assert result.value - result.gap <= truth * (1 + 1e-13)
    assert result.gap <= allowed * (1 + 1e-9)


def assignment(a: np.ndarray, b: np.ndarray, ground: GroundCost = EUCLIDEAN) -> float:
    """The slow twin: the Hungarian method, each point as often as equal numbers take."""
    common = math.lcm(len(a), len(b))
    sides = np.repeat(a, common // len(a), axis=0), np.repeat(b, common // len(b), axis=0)
    cost = cdist(*sides, "sqeuclidean" if ground.squared else "euclidean")
    return float(cost[linear_sum_assignment(cost)].mean())


CLOUD_PAIRS = {
    "resampled": (box(1, LARGE), box(2, LARGE)),
    "shifted": (box(1, LARGE), moved(box(2, LARGE), 0.1, 0.05, 0)),
    "ball for a box": (ball(1, LARGE), box(2, LARGE)),
    "half missing": (half_box(1, 900), box(2, 450)),
    "far off": (moved(box(1, LARGE), 30, 20, 10), box(2, LARGE)),
    "one outlier": (np.vstack([box(1, LARGE - 1), [[50.0, 0, 0]]]), box(2, LARGE)),
    "fewer": (box(1, 400), box(2, LARGE)),
    "one and many": (ball(1, 1), box(2, LARGE)),
    "repetitions": (np.repeat(box(1, 60), 10, axis=0), np.repeat(box(2, 120), 5, axis=0)),
    "on a grid": (np.round(box(1, LARGE) * 8) / 8, np.round(box(2, LARGE) * 8) / 8),
    "on a line": (box(1, LARGE) * [1, 0, 0], box(2, LARGE) * [1, 0, 0]),
    "nearly the same": (box(1, LARGE), moved(box(1, LARGE) * np.array([1, 1, 1.001]), 1e-3, 0, 0)),
    "partly the same": (box(1, LARGE), np.vstack([box(1, LARGE)[60:], box(2, 60)])),
    "small": (box(1, 30), ball(2, 45)),
}


GROUND_COSTS = pytest.mark.parametrize(
    "ground", [EUCLIDEAN, SQUARED_EUCLIDEAN], ids=["distance", "squared"]
)


@GROUND_COSTS
@pytest.mark.parametrize("name", CLOUD_PAIRS)
def test_agrees_with_the_hungarian_method(name, ground):
    a, b = CLOUD_PAIRS[name]
    unit = 2 * np.ptp(np.vstack([a, b]), axis=0).max()  # at most
    min_gap = 1e-12 * unit**2 if ground.squared else 0.0
    assert_certified(certified_emd(a, b, ground), assignment(a, b, ground), min_gap)


@GROUND_COSTS
@pytest.mark.parametrize(
    "name", [name for name in CLOUD_PAIRS if name not in ("small", "one and many")]
)
def test_the_sparse_way_gets_there_by_itself(name, ground):
    """No silent fall-back: speed would be gone, and only the dense way be tested."""
    assert certified_emd(*CLOUD_PAIRS[name], ground).rounds > 0


@GROUND_COSTS
@pytest.mark.parametrize("name", CLOUD_PAIRS)
def test_the_dense_way_finds_the_same(name, ground):
    a, b = CLOUD_PAIRS[name]
    sparse, dense = certified_emd(a, b, ground), certified_emd(a, b, ground, max_rounds=0)
    assert dense.rounds == 0
    assert sparse.value == pytest.approx(dense.value, rel=1e-9, abs=sparse.gap)  # from above


def test_one_point_to_another():
    assert value(np.zeros((1, 3)), np.array([[3.0, 0.0, 4.0]])) == 5.0


def test_weights_are_one_over_n_and_one_over_m():
    # Half of the one point's mass goes 1 to the left, half 3 to the right: (1 + 3) / 2.
    a, b = np.array([[0.0, 0, 0]]), np.array([[-1.0, 0, 0], [3.0, 0, 0]])
    assert value(a, b) == 2.0


def test_is_not_squared():
    # Matched straight: (1 + 4) / 2; the mean square would be 17 / 2, its root 2.9.
    a, b = np.array([[0.0, 0, 0], [0, 100, 0]]), np.array([[1.0, 0, 0], [4, 100, 0]])
    assert value(a, b) == 2.5


@pytest.mark.parametrize(("n", "m"), [(LARGE, LARGE), (400, 700), (5000, 5000)])
def test_on_a_line_points_are_matched_in_order(n, m):
    """W1 in one dimension is the area between the two distribution functions.

    Of all pairs the right way round none undercuts another: millions of ties.
    """
    rng = np.random.default_rng(n)
    x, y = rng.normal(size=n), rng.normal(1, 2, size=m)
    steps = np.sort(np.concatenate([x, y]))
    share = [np.searchsorted(np.sort(z), steps[:-1], side="right") / len(z) for z in (x, y)]
    area = float(np.abs(share[0] - share[1]) @ np.diff(steps))
    direction = np.array([2.0, 3.0, 6.0]) / 7
    assert_certified(certified_emd(x[:, None] * direction, y[:, None] * direction), area)


def test_concentric_spheres_are_their_radii_apart():
    """|x - y| >= | |x| - |y| |, and each point straight outwards attains it."""
    inner = ball(3, 1500)
    result = certified_emd(inner, np.random.default_rng(0).permutation(inner) * 1.5)
    assert result.rounds > 0
    assert_certified(result, 0.25)


def test_a_cloud_is_where_it_is():
    """Zero, from a plan that moves nothing: also shuffled, and with each point twice."""
    cloud = box(4, 2000)
    for other in (cloud, np.random.default_rng(0).permutation(cloud), np.repeat(cloud, 2, axis=0)):
        result = certified_emd(cloud, other)
        assert result.rounds > 0
        assert (result.value, result.gap) == (0.0, 0.0)


def test_one_place_is_no_distance():
    assert certified_emd(np.full((5, 3), 0.1), np.full((900, 3), 0.1)).value == 0.0


def test_two_far_clusters_that_trade_a_point():
    """Two clumps 100 apart with 300 points each, against 299 and 301: one point must travel."""
    clumps, far = ball(5, LARGE) * 1e-3, np.array([100.0, 0, 0])
    here = np.arange(LARGE)[:, None]
    a, b = clumps + (here < 300) * far, clumps + (here < 299) * far
    assert_certified(certified_emd(a, b), 100 / LARGE)


@pytest.mark.parametrize("unit", [2.0**-1000, 2.0**-30, 2.0**40, 2.0**1000])
def test_any_unit_of_length(unit):
    a, b = CLOUD_PAIRS["resampled"]
    assert value(a * unit, b * unit) == value(a, b) * unit  # a power of two: exact


def test_a_length_below_float64s_normal_ones():
    """5 subnormal units, to half a unit."""
    tiny = np.array([[3.0, 0.0, 4.0]]) * 2.0**-1070
    assert value(np.zeros((1, 3)), tiny) == pytest.approx(5 * 2.0**-1070, abs=2.0**-1074)


def test_far_from_the_origin_nothing_changes():
    """Points on a grid of 2^-20, moved by 2^20: coordinates are exact, so the bytes the same."""
    a, b = (np.round(cloud * 2**20) / 2**20 for cloud in CLOUD_PAIRS["ball for a box"])
    assert certified_emd(a + 2.0**20, b + 2.0**20) == certified_emd(a, b)


@given(SEEDS, SIZES)
def test_translating_a_cloud_costs_the_length_of_the_translation(seed, n):
    """W1(X, X + v) = |v|: the mean displacement bounds it below, the identity above."""
    cloud, shift = box(seed, n), np.random.default_rng(seed).normal(size=3)
    # 1e-9 as promised; rounding of coordinates of about 1 is nothing beside it.
    assert value(cloud, cloud + shift) == pytest.approx(np.linalg.norm(shift), rel=1e-9)


@given(SEEDS, SIZES, SIZES, st.floats(1e-3, 1e3))
def test_scales_with_the_clouds_and_ignores_their_place(seed, n, m, scale):
    a, b = box(seed, n), ball(seed, m)
    offset = np.random.default_rng(seed).normal(size=3) * 100
    # Moved 100 away coordinates lose 100 eps = 2e-14; each value is within 1e-9 of its truth.
    assert value(a * scale + offset, b * scale + offset) == pytest.approx(
        value(a, b) * scale, rel=2e-9, abs=1e-12
    )


@given(SEEDS, SIZES, SIZES)
def test_is_symmetric(seed, n, m):
    a, b = box(seed, n), ball(seed, m)
    assert value(a, b) == pytest.approx(value(b, a), rel=1e-9)  # each from above, within 1e-9


@given(SEEDS, SIZES, SIZES, SIZES)
@settings(max_examples=20)
def test_a_detour_is_no_shorter(seed, n, m, k):
    a, b, c = box(seed, n), ball(seed, m), box(seed + 1, k) * 2
    assert value(a, c) <= (value(a, b) + value(b, c)) * (1 + 1e-9)


@given(SEEDS, SIZES, SIZES)
def test_order_of_points_does_not_matter(seed, n, m):
    a, b, rng = box(seed, n), ball(seed, m), np.random.default_rng(seed)
    assert value(rng.permutation(a), rng.permutation(b)) == pytest.approx(value(a, b), rel=1e-9)


def test_same_clouds_same_bytes_and_nothing_is_touched():
    a, b = (cloud.copy() for cloud in CLOUD_PAIRS["ball for a box"])
    first = certified_emd(a, b)
    assert certified_emd(a, b) == first
    np.testing.assert_array_equal(a, CLOUD_PAIRS["ball for a box"][0])
    np.testing.assert_array_equal(b, CLOUD_PAIRS["ball for a box"][1])


def test_float32_loses_no_digits():
    """|a|^2 + |b|^2 - 2ab in float32, 50 mm from the origin, is off by 0.04 mm."""
    a = (box(6, LARGE) + 50).astype(np.float32)
    assert value(a, a) == 0.0


# Failure: what cannot be proven is an error.


def test_a_graph_without_a_plan_gives_no_number():
    """Two points of `a` may only go to one of `b`.  POT itself returns 0.0 and warns."""
    a, b, _ = normalize_clouds(box(1, 3), box(2, 3))
    pair_ids = np.array([0, 3, 7, 8])  # (0, 0), (1, 0), (2, 1), (2, 2)
    with pytest.raises(MetricError, match=r"POT did not solve .* infeasible"):
        module._solve_sparse(a, b, EUCLIDEAN, pair_ids, (np.zeros(3), np.zeros(3)), 1000)


def test_without_usable_candidates_the_dense_problem_is_solved(monkeypatch):
    def starved(*arguments):
        cells, plan, _ = initial_solution(*arguments)
        return cells, plan, np.arange(LARGE) * LARGE  # every point of `a` to point 0

    initial_solution = module._initial_solution
    monkeypatch.setattr(module, "_initial_solution", starved)
    a, b = CLOUD_PAIRS["resampled"]
    result = certified_emd(a, b)
    assert result.rounds == 0
    assert_certified(result, assignment(a, b))


def test_few_candidates_only_cost_rounds(monkeypatch):
    """Starting from the pairs of a rough plan alone, pricing finds every pair that matters."""

    def bare(*arguments):
        cells, plan, _ = initial_solution(*arguments)
        return cells, plan, np.unique(plan.rows * LARGE + plan.cols)

    initial_solution = module._initial_solution
    a, b = CLOUD_PAIRS["resampled"]
    usual = certified_emd(a, b)
    monkeypatch.setattr(module, "_initial_solution", bare)
    result = certified_emd(a, b)
    assert result.rounds > usual.rounds
    assert_certified(result, assignment(a, b))


@GROUND_COSTS
def test_after_the_first_round_few_pairs_are_solved(ground):
    """The solver's time goes by their number; the first round has 18 a point and more."""
    a, b = box(1, 3000), box(2, 3000)
    assert certified_emd(a, b, ground, max_rounds=1).rounds == 0  # the first round is not enough
    result = certified_emd(a, b, ground)
    assert result.pairs < 12 * len(a)
    assert result.value == pytest.approx(certified_emd(a, b, ground, max_rounds=0).value, rel=1e-12)


def test_too_few_rounds_fall_back_to_the_dense_problem():
    a, b = CLOUD_PAIRS["half missing"]
    assert certified_emd(a, b).rounds > 1
    result = certified_emd(a, b, max_rounds=1)
    assert result.rounds == 0
    assert_certified(result, assignment(a, b))


@pytest.mark.parametrize("n", [100, LARGE])
@pytest.mark.parametrize("max_rounds", [0, 30])
def test_a_cut_iteration_budget_is_an_error(n, max_rounds):
    with pytest.raises(MetricError, match="max_pivots=50"):
        certified_emd(box(1, n), box(2, n), max_pivots=50, max_rounds=max_rounds)


def test_a_solver_that_errs_is_found_out(monkeypatch):
    """A plan and prices of other clouds: feasible, called optimal, and refused both ways."""

    def other_problem(a, b, cost, max_pivots):
        flow = np.zeros(cost.shape)
        flow[np.arange(len(flow)), np.arange(len(flow))] = a.mass
        return (coo_array(flow) if issparse(cost) else flow), np.zeros(len(b.mass))

    monkeypatch.setattr(module, "_network_simplex", other_problem)
    for n in (100, LARGE):
        with pytest.raises(MetricError, match="not proven"):
            certified_emd(box(1, n), box(2, n))


def test_prices_that_fit_the_plan_and_undercut_others_are_found_out(monkeypatch):
    """The identity, with prices that pay for just that: only the check of all pairs objects."""

    def identity(a, b, *_):
        each = np.arange(len(a.mass))
        lengths = np.linalg.norm(a.points - b.points, axis=1)
        return TransportPlan(each, each, a.mass, lengths, np.zeros(len(b.mass)))

    monkeypatch.setattr(module, "_solve_dense", identity)
    monkeypatch.setattr(module, "_solve_sparse", identity)
    for n in (100, LARGE):
        with pytest.raises(MetricError, match="not proven"):
            certified_emd(box(1, n), box(2, n))


@pytest.mark.parametrize("bad", [np.empty((0, 3)), np.array([[0.0, np.nan, 0.0]])])
def test_unusable_clouds_are_refused_by_name(bad):
    with pytest.raises(MetricError, match="'a'"):
        value(bad, np.zeros((1, 3)))
    with pytest.raises(MetricError, match="'b'"):
        value(np.zeros((1, 3)), bad)


def test_clouds_beyond_float64_are_refused():
    with pytest.raises(MetricError, match="too far"):
        value(np.full((1, 3), -1.7e308), np.full((1, 3), 1.7e308))


def test_pot_is_loaded_late_and_without_torch():
    code = (
        "import sys; import numpy as np; from industnerf import emd\n"
        "assert 'ot' not in sys.modules\n"
        "assert emd(np.zeros((1, 3)), np.ones((1, 3))).value > 0\n"
        "assert 'ot' in sys.modules and 'torch' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_large_clouds_are_not_small():
    assert LARGE * 400 > DENSE_PAIRS
    assert DENSE_PAIRS < 370 * 370
    assert DENSE_POINTS < 370
