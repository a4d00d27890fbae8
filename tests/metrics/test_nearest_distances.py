"""Distances between clouds against SciPy's tree, near and far apart."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from industnerf.metrics.nearest_distances import distance_to_nearest, nearest_distances


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
