"""Signed distances in closed form."""

import numpy as np
import pytest

from industnerf.deviation.surface import Surface
from tests.deviation import block

SOLID = block.mesh()
SURFACE = Surface(np.array(SOLID.vertices), np.array(SOLID.faces))


@pytest.mark.parametrize("offset", [0.1, -0.1, 2.0, -0.5])
def test_a_plane_that_is_offset_is_off_by_just_that(offset):
    """Float32 about the center of a part of 75 mm: 4e-6 mm."""
    rng = np.random.default_rng(0)
    bottom = rng.uniform([12, 2, 0], [58, 38, 0], (500, 3)) - [0, 0, offset]
    nearest = SURFACE.nearest(bottom)
    np.testing.assert_allclose(nearest.signed_distance, offset, atol=2e-5)
    np.testing.assert_allclose(nearest.points[:, 2], 0, atol=2e-5)
    np.testing.assert_allclose(nearest.normals, [[0, 0, -1]] * 500, atol=1e-6)


def test_beside_an_edge_and_a_corner_the_sign_is_that_of_the_side():
    """Where the nearest point is on a border, the normal of either face alone would mislead."""
    outside = np.array([[-3.0, -4, 10], [-1, -2, -2], [60 + 3, 40 + 4, 5]])
    expected = [5, 3, 5]
    np.testing.assert_allclose(SURFACE.nearest(outside).signed_distance, expected, atol=1e-5)
    inside = np.array([[30.0, 20, 3], [39, 20, 9], [59.5, 39.5, 9.8]])
    expected = [-3, -np.sqrt(2), -0.2]  # the second is under the edge of the step, which points in
    np.testing.assert_allclose(SURFACE.nearest(inside).signed_distance, expected, atol=2e-5)


def test_far_from_the_origin_it_is_as_exact_as_the_part_is_small():
    far = Surface(np.array(SOLID.vertices) + 1e5, np.array(SOLID.faces))
    point = np.array([[30.0, 20.0, -0.1]]) + 1e5
    np.testing.assert_allclose(far.nearest(point).signed_distance, [0.1], atol=2e-5)
