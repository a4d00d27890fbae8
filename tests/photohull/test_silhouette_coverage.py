"""How much of a ball's silhouettes parts of the ball fill, against closed forms."""

import numpy as np
import pytest

from industnerf.photohull import silhouette_coverage
from industnerf.photohull.voxel_grid import unit_frame_cameras_about
from tests.methods.solids import cameras_around, masks_of_ball

RADIUS, REACH = 20.0, 30.0  # mm
CAMERAS = cameras_around(40, 192, REACH)
MASK = masks_of_ball(RADIUS, CAMERAS)
RIG = unit_frame_cameras_about(CAMERAS, np.zeros(3), REACH)
AT = (np.indices((64, 64, 64)) + 0.5) / 32 - 1
BALL = np.linalg.norm(AT, axis=0) < RADIUS / REACH


def test_a_solid_fills_its_own_silhouettes():
    assert silhouette_coverage(BALL, MASK, RIG) == 1


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_half_a_ball_fills_three_quarters(axis):
    """From the angle t to its axis a half shows pi r^2 (1 + |cos t|) / 2, in the mean 3/4.

    The cut is widened by up to two of the pixels, of which the ball's width is 42: up to 0.05.
    """
    half = BALL & (AT[axis] > 0)
    assert 0.745 < silhouette_coverage(half, MASK, RIG) < 0.80


def test_a_hollow_does_not_show():
    """What is carved out behind the surface, as of a cup, is missed in no silhouette."""
    shell = BALL & (np.linalg.norm(AT, axis=0) > 0.8 * RADIUS / REACH)
    assert silhouette_coverage(shell, MASK, RIG) == 1


def test_nothing_fills_nothing():
    assert silhouette_coverage(np.zeros_like(BALL), MASK, RIG) == 0
    assert silhouette_coverage(np.zeros_like(BALL), np.zeros_like(MASK), RIG) == 1
