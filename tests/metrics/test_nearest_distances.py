"""Distances between clouds against SciPy's tree, near and far apart."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from industnerf.errors import MetricError
from industnerf.metrics.nearest_distances import (
    chamfer,
    distance_to_nearest,
    fscore,
    nearest_distances,
    share_within,
)


def sphere(seed: int, radius: float) -> np.ndarray:
    points = np.random.default_rng(seed).normal(size=(3000, 3))
    return radius * points / np.linalg.norm(points, axis=1, keepdims=True)


@pytest.mark.parametrize("radius", [1.0, 3.0, 1e6])
def test_the_tree_finds_what_scipys_finds(radius):
    """The same squares summed in the same order: equal but for an eps of the root."""
    truth, predicted = sphere(0, 1.0), sphere(1, radius)
    distances = nearest_distances(truth, predicted)
    np.testing.assert_allclose(
        distances.truth_to_predicted, cKDTree(predicted).query(truth)[0], rtol=1e-15
    )
    np.testing.assert_allclose(
        distances.predicted_to_truth, cKDTree(truth).query(predicted)[0], rtol=1e-15
    )


def test_single_points_and_none():
    a, b = np.zeros((1, 3)), np.array([[3.0, 0.0, 4.0]])
    assert distance_to_nearest(a, b) == 5
    assert distance_to_nearest(np.zeros((0, 3)), b).shape == (0,)
    twice = np.concatenate([b, b])
    assert distance_to_nearest(twice, twice).tolist() == [0, 0]


def cloud(seed: int, n: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(n, 3))


SEEDS, SIZES = st.integers(0, 10**6), st.integers(1, 60)


def test_one_point_against_two():
    # From a: 3 to the nearer.  From b: 3 and 5, mean 4.  Half their sum: 3.5, in first order.
    a = np.array([[0.0, 0.0, 0.0]])
    b = np.array([[3.0, 0.0, 0.0], [0.0, 4.0, 3.0]])
    assert chamfer(nearest_distances(a, b)) == 3.5


@given(SEEDS, SIZES, SIZES)
def test_agrees_with_all_distances(seed, n, m):
    a, b = cloud(seed, n), cloud(seed + 1, m)
    all_pairs = cdist(a, b)
    truth = (all_pairs.min(axis=1).mean() + all_pairs.min(axis=0).mean()) / 2
    # Both add the same 120 distances, in another order: 120 eps.
    assert chamfer(nearest_distances(a, b)) == pytest.approx(truth, rel=1e-13)


@given(SEEDS, SIZES, SIZES)
def test_is_symmetric_and_scales(seed, n, m):
    a, b = cloud(seed, n), cloud(seed + 1, m)
    assert chamfer(nearest_distances(a, b)) == chamfer(nearest_distances(b, a))
    assert chamfer(nearest_distances(4 * a, 4 * b)) == 4 * chamfer(
        nearest_distances(a, b)
    )  # a power of two: exact


def test_a_shifted_grid_is_its_shift_away():
    """Spacing 1, shift 1/4: the nearest point is the shifted one."""
    grid = np.stack(np.meshgrid(*[np.arange(5.0)] * 3), axis=-1).reshape(-1, 3)
    assert chamfer(nearest_distances(grid, grid + np.array([0.25, 0, 0]))) == 0.25
    assert chamfer(nearest_distances(grid, grid)) == 0


@pytest.mark.parametrize("bad", [np.empty((0, 3)), np.array([[0.0, np.nan, 0.0]])])
def test_unusable_clouds_are_refused_by_name(bad):
    with pytest.raises(MetricError, match="'predicted'"):
        nearest_distances(np.zeros((1, 3)), bad)


def on_axis(*x: float) -> np.ndarray:
    return np.array([[value, 0.0, 0.0] for value in x])


TRUTH = on_axis(0, 1, 2, 3)
PREDICTED = on_axis(0.5, 10)
DISTANCES = nearest_distances(TRUTH, PREDICTED)


def test_shares_are_directed():
    assert (
        share_within(DISTANCES.predicted_to_truth, 0.6) == 1 / 2
    )  # 0.5 is near 0, 10 near nothing
    assert share_within(DISTANCES.truth_to_predicted, 0.6) == 2 / 4  # 0 and 1 are near 0.5
    assert share_within(DISTANCES.truth_to_predicted, 1.6) == 3 / 4
    assert share_within(DISTANCES.predicted_to_truth, 1.6) == 1 / 2


def test_the_distance_itself_counts():
    assert share_within(DISTANCES.predicted_to_truth, 0.5) == 1 / 2
    assert share_within(DISTANCES.predicted_to_truth, np.nextafter(0.5, 0)) == 0


def test_fscore_is_the_harmonic_mean():
    precision, recall = 1 / 2, 3 / 4
    # Same two divisions and a product: a few eps.
    truth = 2 / (1 / precision + 1 / recall)
    assert fscore(DISTANCES, 1.6) == pytest.approx(truth, rel=1e-15)


def test_fscore_of_nothing_near_is_zero_and_of_the_truth_is_one():
    assert fscore(nearest_distances(TRUTH, on_axis(100)), 1.0) == 0
    assert fscore(nearest_distances(TRUTH, TRUTH), 1e-9) == 1


@pytest.mark.parametrize("distance", [0.0, -1.0, np.nan, np.inf])
def test_a_meaningless_distance_is_refused(distance):
    with pytest.raises(MetricError, match="positive length"):
        fscore(DISTANCES, distance)


def test_an_empty_prediction_is_refused():
    with pytest.raises(MetricError, match="empty"):
        nearest_distances(TRUTH, np.empty((0, 3)))
