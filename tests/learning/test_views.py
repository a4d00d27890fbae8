"""What scaling makes of known photographs, and the axes of a picture against its camera."""

import numpy as np
import pytest

from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.geometry.cameras import Cameras, project
from industnerf.learning.views import picture_frames, resize_images
from tests.methods.solids import DISTANCE, cameras_around


def noise(size, n=2):
    return np.random.default_rng(0).integers(0, 256, (n, size, size, 3), np.uint8)


def test_a_scaled_pixel_is_the_mean_of_its_block():
    images = noise(12)
    blocks = images.reshape(2, 3, 4, 3, 4, 3).mean(axis=(2, 4))
    # rounded to whole levels, after either direction
    np.testing.assert_allclose(resize_images(images, 3), blocks, rtol=0, atol=1.0)


def test_at_its_own_size_a_picture_stays_as_it_is():
    images = noise(9)
    np.testing.assert_array_equal(resize_images(images, 9), images)


@pytest.mark.parametrize("px", [5, 7])
def test_where_sizes_do_not_divide_it_is_the_mean_of_the_centers_covered(px):
    images = noise(16)
    window = ((np.arange(16) + 0.5) * px / 16).astype(int)  # no center is on a border: 16 is even
    share = (window == np.arange(px)[:, None]) / np.bincount(window)[:, None]
    means = np.einsum("ij,kl,njlc->nikc", share, share, images)
    # rounded to whole levels after either direction
    np.testing.assert_allclose(resize_images(images, px), means, rtol=0, atol=1.0)


def test_white_stays_white_and_sides_stay_apart():
    images = np.full((1, 16, 16, 3), 255, np.uint8)
    images[:, :8] = [255, 0, 0]
    small = resize_images(images, 5)
    assert (small[:, :2] == [255, 0, 0]).all()
    assert (small[:, 3:] == 255).all()


CUBE = BoundingCube(np.array([5.0, -2.0, 7.0]), 40.0)
CAMERAS = cameras_around(5, 64, 30.0, tuple(CUBE.center_mm))


def test_in_picture_axes_points_lie_where_the_picture_shows_them():
    """Its coordinates are widths of the picture from its middle, but for perspective.

    Exactly: a point z behind the middle is 1 + z / (focal length in widths) times as far away.
    """
    points = np.random.default_rng(0).uniform(-0.5, 0.5, (50, 3))
    for K, c2w, frame in zip(CAMERAS.K, CAMERAS.c2w, picture_frames(CAMERAS, CUBE), strict=True):
        x, y, z = (points @ frame).T
        uv, depth = project(CUBE.to_mm(points), K, c2w)
        farther = 1 + z * CAMERAS.width / K[0, 0]
        np.testing.assert_allclose(farther, depth / (DISTANCE * 30.0), rtol=1e-9)
        np.testing.assert_allclose(x / farther, uv[:, 0] / 64 - 0.5, rtol=0, atol=1e-9)
        np.testing.assert_allclose(y / farther, uv[:, 1] / 64 - 0.5, rtol=0, atol=1e-9)


def test_a_small_step_of_a_part_beside_the_axis_moves_its_image_as_far():
    """To first order, and to the angle off the axis: 3 mm at 123 mm, 0.024 of the step."""
    aside = BoundingCube(CUBE.center_mm + np.array([2.0, 2.0, -1.0]), CUBE.edge_mm)
    steps = 1e-5 * np.random.default_rng(0).uniform(-1, 1, (50, 3))
    for K, c2w, frame in zip(CAMERAS.K, CAMERAS.c2w, picture_frames(CAMERAS, aside), strict=True):
        start, there = (project(aside.to_mm(p), K, c2w)[0] for p in (np.zeros((1, 3)), steps))
        largest = np.abs(steps @ frame).max()
        np.testing.assert_allclose(
            (there - start) / 64, (steps @ frame)[:, :2], rtol=0, atol=0.03 * largest
        )


def test_what_looks_as_large_is_as_large_whatever_the_scale_of_the_part():
    frames = picture_frames(CAMERAS, CUBE)
    c2w = CAMERAS.c2w.copy()
    c2w[:, :3, 3] *= 1000
    larger = Cameras(CAMERAS.K, c2w, CAMERAS.width, CAMERAS.height)
    same = picture_frames(larger, BoundingCube(1000 * CUBE.center_mm, 1000 * CUBE.edge_mm))
    np.testing.assert_allclose(same, frames, rtol=1e-9, atol=1e-12)
    half = picture_frames(CAMERAS, BoundingCube(CUBE.center_mm, CUBE.edge_mm / 2))
    np.testing.assert_allclose(half, frames / 2, rtol=1e-12, atol=1e-15)
