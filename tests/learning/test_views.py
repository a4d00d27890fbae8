"""Which photographs are taken, and what scaling makes of known ones."""

import numpy as np
import pytest

from industnerf.geometry.cameras import project
from industnerf.learning.views import (
    apply_camera_roll,
    axis_rotations,
    evenly_spaced_indices,
    resize_images,
)
from tests.methods.solids import cameras_around


@pytest.mark.parametrize(
    ("total", "count", "expected"),
    [
        (40, 8, [0, 5, 10, 15, 20, 25, 30, 35]),
        (10, 3, [0, 3, 6]),
        (7, 7, [0, 1, 2, 3, 4, 5, 6]),
        (3, 8, [0, 1, 2]),
        (5, 1, [0]),
        (0, 4, []),
    ],
)
def test_evenly_takes_every_so_manieth(total, count, expected):
    assert evenly_spaced_indices(total, count).tolist() == expected


def test_gaps_differ_by_one_at_most():
    for total in range(1, 50):
        for count in range(1, total + 1):
            gaps = np.diff(
                [*evenly_spaced_indices(total, count), total]
            )  # the last gap leads back to the first
            assert gaps.min() >= 1
            assert np.ptp(gaps) <= 1


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
