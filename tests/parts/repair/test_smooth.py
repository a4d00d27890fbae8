"""Taubin's steps: noise goes, size stays."""

import numpy as np
import pytest

from industnerf.parts.repair.smooth import smooth
from tests.parts.repair.shapes import ball, box, select_faces, settings, volume

BALL = ball(0.5, subdivisions=4)


def test_nothing_is_smoothed_unless_asked():
    solids = [box()]
    assert smooth(solids, settings()) == (solids, [], [])


def test_noise_goes_and_the_volume_stays():
    rng = np.random.default_rng(0)
    noisy = ball(0.5, subdivisions=4)
    noisy.vertices[:] *= 1 + 0.01 * rng.standard_normal((len(noisy.vertices), 1))
    [smoothed], repairs, defects = smooth([noisy], settings(smooth_steps=10))
    radius = np.linalg.norm(smoothed.vertices, axis=1)
    before = np.linalg.norm(noisy.vertices, axis=1)
    assert radius.std() < before.std() / 2  # waves of many facets stay, by design
    # Without the growing step, ten halvings of the way to the mean shrink it by 4 %.
    assert volume(smoothed) == pytest.approx(volume(BALL), rel=5e-3)
    assert repairs[0].startswith("smoothed in 10 steps: vertices moved by up to ")
    assert defects == []


def test_a_linear_function_of_an_even_grid_stays():
    """The mean of the neighbors of a vertex inside an even plane grid is the vertex itself."""
    n = 9
    x, y = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    vertices = np.stack([x, y, 2 * x - y], -1).reshape(-1, 3).astype(float)
    corner = (n * x + y)[:-1, :-1].ravel()
    halves = ((0, n, n + 1), (0, n + 1, 1))
    faces = np.concatenate([corner[:, None] + np.array(half) for half in halves])
    plane = type(box())(vertices, faces.astype(np.int32), np.zeros(len(faces), np.uint8))
    [smoothed], _, _ = smooth([plane], settings(smooth_steps=5))
    np.testing.assert_allclose(smoothed.vertices, vertices, atol=1e-12)  # a few dozen roundings


def test_borders_stay():
    half = select_faces(BALL, BALL.triangles[..., 2].max(axis=1) < 1e-9)
    [smoothed], _, _ = smooth([half], settings(smooth_steps=5))
    rim = np.abs(half.vertices[:, 2]) < 1e-9
    np.testing.assert_array_equal(smoothed.vertices[rim], half.vertices[rim])
    assert not np.array_equal(smoothed.vertices, half.vertices)
