"""The axes of a view, against what its camera sees."""

import numpy as np

from industnerf.geometry.cameras import project
from industnerf.learning.axis_alignment import apply_camera_roll, axis_rotations
from tests.methods.solids import cameras_around

CAMERAS = cameras_around(5, 64, 30.0)


def test_in_the_axes_of_a_view_points_are_right_down_and_forwards_of_its_camera():
    points = np.random.default_rng(0).uniform(-20, 20, (50, 3))
    for K, c2w, rotation in zip(
        CAMERAS.K, CAMERAS.c2w, axis_rotations(CAMERAS, "view"), strict=True
    ):
        x, y, z = ((points - c2w[:3, 3]) @ rotation).T
        uv, depth = project(points, K, c2w)
        np.testing.assert_allclose(z, depth, rtol=1e-12)
        np.testing.assert_allclose(K[0, 0] * x / z + K[0, 2], uv[:, 0], rtol=1e-9)
        np.testing.assert_allclose(K[1, 1] * y / z + K[1, 2], uv[:, 1], rtol=1e-9)


def test_in_those_of_the_part_they_stay():
    np.testing.assert_array_equal(axis_rotations(CAMERAS, "part"), np.tile(np.eye(3), (5, 1, 1)))


def test_a_roll_turns_the_axes_of_a_view_and_not_those_of_the_part():
    quarter = np.tile([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]], (5, 1, 1))
    rotations = axis_rotations(CAMERAS, "view")
    right, down, forwards = np.moveaxis(rotations, 2, 0)
    result = np.moveaxis(apply_camera_roll(rotations, quarter, "view"), 2, 0)
    np.testing.assert_allclose(result, [down, -right, forwards], atol=1e-15)
    np.testing.assert_array_equal(apply_camera_roll(rotations, quarter, "part"), rotations)
