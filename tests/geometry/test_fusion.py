"""Depth images and their mean: what one image says, and what it does not."""

import numpy as np
import pytest

from industnerf.geometry import fusion
from industnerf.geometry.cameras import projections_from_ball
from tests.methods.solids import cameras_around

CAMERAS = cameras_around(5, 192, 30.0)
AHEAD = np.eye(3, 4, dtype=np.float32)  # u = x / z, v = y / z


def test_cells_behind_a_camera_are_in_no_image():
    """With a wide lens close by, corners of the cube are behind cameras."""
    image = fusion.Image(np.ones((8, 8), np.float32), AHEAD)
    behind = np.array([[1.0, 1, -1], [4, 4, -1]], np.float32)
    assert not image.empty(behind, 0.1).any()
    assert (image.look(behind, 0.1)[1] == 0).all()


def test_a_pixel_of_which_nothing_is_known_says_nothing():
    """Nor does one beside it, of what is empty: the part may reach into it."""
    depth = np.full((3, 8), 2.0, np.float32)
    depth[1, 4] = fusion.UNKNOWN
    image = fusion.Image(depth, AHEAD)
    before = np.array([[u + 0.5, 1.5, 1] for u in range(8)], np.float32)
    assert image.empty(before, 0.1).tolist() == [True] * 3 + [False] * 3 + [True] * 2
    assert not image.empty(2 * before, 0.1).any()
    weights = image.look(2 * before, 0.1)[1]
    assert weights[4] == 0
    assert (np.delete(weights, 4) == 1).all()


def test_a_slope_is_measured_on_the_flatter_side():
    depth = np.full((5, 7), fusion.STEEP)
    depth[:, 3:] = np.float32([2, 2.5, 3, 3.5])
    # 0.5 per column, nothing per row, also at the outline and at the border
    np.testing.assert_allclose(fusion.slopes(depth)[:, 3:], 0.5)


def test_the_focal_length_is_read_from_a_projection():
    projection = projections_from_ball(CAMERAS, np.array([1.0, 2, 3]), 17.0)
    for one in projection:
        assert fusion.focal_of(one) == pytest.approx(CAMERAS.K[0, 0, 0], rel=1e-5)  # float32
