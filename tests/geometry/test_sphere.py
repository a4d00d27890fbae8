"""The Fibonacci sphere is even, and turns as a whole."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.geometry.sphere import fibonacci_hemisphere, fibonacci_sphere


@given(st.integers(1, 300), st.floats(-10, 10))
def test_all_are_unit_vectors_on_rings_of_equal_area(n, rotation):
    points = fibonacci_sphere(n, rotation)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1, rtol=0, atol=1e-14)
    np.testing.assert_allclose(np.diff(points[:, 2]), -2 / n, rtol=0, atol=1e-14)


@pytest.mark.parametrize("n", [20, 40, 100, 400])
def test_neighbors_keep_their_distance(n):
    """Each point has 4 pi / n of area; on a hexagonal lattice the spacing is sqrt(2/sqrt 3 a).

    That is the best possible; the Fibonacci lattice is known to keep above 80 % of it.
    """
    best = np.sqrt(2 / np.sqrt(3) * 4 * np.pi / n)
    points = fibonacci_sphere(n)
    gaps = np.linalg.norm(points[:, None] - points, axis=2) + 9 * np.eye(n)
    assert 0.8 * best < gaps.min() < best


def test_it_has_no_bias_to_a_side():
    """The mean of n even points vanishes like 1/n; random ones would give 1/sqrt(n) = 0.03."""
    assert np.linalg.norm(fibonacci_sphere(1000).mean(axis=0)) < 2e-3


def test_turning_rotates_about_z():
    quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    np.testing.assert_allclose(
        fibonacci_sphere(17, np.pi / 2), fibonacci_sphere(17) @ quarter.T, rtol=0, atol=1e-14
    )


@given(st.integers(1, 300), st.floats(-10, 10))
def test_the_hemisphere_has_rings_of_equal_area_above_the_horizon(n, rotation):
    points = fibonacci_hemisphere(n, rotation)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1, rtol=0, atol=1e-14)
    np.testing.assert_allclose(points[:, 2], 1 - (np.arange(n) + 0.5) / n, rtol=0, atol=1e-14)
