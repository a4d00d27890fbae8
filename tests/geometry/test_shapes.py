"""Ball and box: on their surface, and equally likely everywhere on it."""

import numpy as np
import pytest

from industnerf.geometry.shapes import ball_surface, box_surface

EXTENTS, CENTER = np.array([3.0, 8.0, 20.0]), np.array([100.0, -50.0, 7.0])
N = 40_000


def test_the_ball_has_the_mean_extent_for_its_diameter():
    points = ball_surface(EXTENTS, CENTER, N, np.random.default_rng(0))
    radius = np.linalg.norm(points - CENTER, axis=1)
    np.testing.assert_allclose(radius, (3 + 8 + 20) / 3 / 2, rtol=1e-12)


def test_the_ball_is_uniform():
    """Along any axis a uniform sphere is uniform (Archimedes' hat box)."""
    points = ball_surface(EXTENTS, CENTER, N, np.random.default_rng(0)) - CENTER
    unit = points / np.linalg.norm(points, axis=1, keepdims=True)
    axes = np.vstack([np.eye(3), np.ones(3) / np.sqrt(3)])
    for along in (unit @ axes.T).T:
        counts, _ = np.histogram(along, 20, (-1, 1))
        z = (counts - N / 20) / np.sqrt(N / 20 * 0.95)
        assert np.abs(z).max() < 4  # of 80 counts, by chance once in 200 seeds


def test_every_point_of_the_box_is_on_one_of_its_faces():
    points = box_surface(EXTENTS, CENTER, N, np.random.default_rng(0))
    beyond = np.abs(points - CENTER) - EXTENTS / 2
    np.testing.assert_allclose(beyond.max(axis=1), 0, atol=1e-12)


def test_the_box_is_uniform():
    """Six faces, by area, and the four quarters of each."""
    points = (box_surface(EXTENTS, CENTER, N, np.random.default_rng(0)) - CENTER) / EXTENTS
    face = np.abs(points).argmax(axis=1)
    side, across = points[np.arange(N), face] > 0, (face[:, None] + [1, 2]) % 3
    quarter = np.take_along_axis(points, across, axis=1) > 0
    cell = np.ravel_multi_index((face, side, *quarter.T), (3, 2, 2, 2))
    share = np.repeat(1 / EXTENTS / (1 / EXTENTS).sum() / 8, 8)
    z = (np.bincount(cell, minlength=24) - N * share) / np.sqrt(N * share * (1 - share))
    assert np.abs(z).max() < 4  # by chance once in 650 seeds


def test_a_flat_box_has_two_faces_and_a_line_none():
    points = box_surface(np.array([3.0, 8.0, 0.0]), CENTER, 1000, np.random.default_rng(0))
    np.testing.assert_array_equal(points[:, 2], CENTER[2])
    assert np.ptp(points, axis=0)[:2] == pytest.approx([3, 8], rel=0.05)
    with pytest.raises(ValueError, match="no surface"):
        box_surface(np.array([3.0, 0.0, 0.0]), CENTER, 10, np.random.default_rng(0))
