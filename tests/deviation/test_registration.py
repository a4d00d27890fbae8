"""Known moves are undone."""

import numpy as np
import pytest

from industnerf.deviation.registration import IDENTITY, Similarity, free_scale, register
from industnerf.deviation.surface import Surface
from tests.deviation import block

DIAGONAL = float(np.linalg.norm([60, 40, 20]))


def surface_of(solid):
    return Surface(np.array(solid.vertices), np.array(solid.faces))


def worst(move, undone, solid) -> float:
    """How far the corners of the part end from where they were, in diagonals."""
    corners = np.array(solid.vertices)
    return float(np.linalg.norm(move(undone(corners)) - corners, axis=1).max() / DIAGONAL)


def test_a_rigid_move_is_undone_exactly_of_exact_points():
    solid = block.mesh()
    found = register(block.MOVE(block.cloud(solid)), surface_of(solid), with_scale=False)
    assert worst(found.move, block.MOVE, solid) < 1e-5  # float32, and where the steps end
    assert found.move.scale == 1.0
    assert found.runner_up > 100 * found.cost


def test_noise_strays_and_a_missing_third_are_survived():
    """Noise of 0.3 % of the diagonal on thousands of points leaves hundredths of that."""
    solid, rng = block.mesh(), np.random.default_rng(1)
    points = block.cloud(solid)
    points = (
        points[points[:, 0] < 45] + rng.normal(size=(8000, 3))[: (points[:, 0] < 45).sum()] * 0.2
    )
    points = np.vstack([points, rng.uniform(-40, 100, (400, 3))])
    found = register(block.MOVE(points), surface_of(solid), with_scale=False)
    assert worst(found.move, block.MOVE, solid) < 1e-3


def test_a_small_notch_tells_the_four_poses_of_a_plate_apart():
    solid = block.nearly_symmetric()
    found = register(block.MOVE(block.cloud(solid)), surface_of(solid), with_scale=False)
    assert worst(found.move, block.MOVE, solid) < 1e-3


def test_of_a_box_another_pose_fits_as_well_and_it_is_left_where_it_lies():
    solid = block.box((60, 40, 20), (0, 0, 0))
    points = block.cloud(solid) + np.random.default_rng(0).normal(size=(8000, 3)) * 0.05
    found = register(points, surface_of(solid), with_scale=False)
    assert worst(found.move, IDENTITY, solid) < 1e-3
    assert found.runner_up < 1.05 * found.cost


def test_a_scale_is_found_if_it_is_asked_for():
    solid = block.mesh()
    shrunk = Similarity(block.GENERIC, np.array([3.0, 1.0, -2.0]), 0.037)
    found = register(shrunk(block.cloud(solid)), surface_of(solid), with_scale=True)
    assert found.move.scale == pytest.approx(1 / 0.037, rel=1e-4)
    assert worst(found.move, shrunk, solid) < 1e-3
    scale, cost = free_scale(1.01 * block.cloud(solid), surface_of(solid), IDENTITY)
    assert (scale, cost < 1e-4 * DIAGONAL) == (pytest.approx(1 / 1.01, rel=1e-4), True)


def test_it_is_the_same_each_time():
    solid = block.mesh()
    points = block.MOVE(block.cloud(solid, 3000))
    a, b = (register(points, surface_of(solid), with_scale=False).move for _ in range(2))
    np.testing.assert_array_equal(a.matrix(), b.matrix())


def test_a_matrix_says_what_the_move_does():
    move = Similarity(block.GENERIC, np.array([1.0, 2.0, 3.0]), 2.0)
    points = np.random.default_rng(0).normal(size=(5, 3))
    homogeneous = np.hstack([points, np.ones((5, 1))]) @ move.matrix().T
    np.testing.assert_allclose(move(points), homogeneous[:, :3], atol=1e-12)
