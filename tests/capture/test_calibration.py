"""Recorded cameras are wrong by as much as asked, training cameras alone."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.capture.calibration import is_exact, recorded
from industnerf.capture.chance import draws_of
from industnerf.capture.rigs import cameras_around

CENTRE, RADIUS = np.array([100.0, -20, 7]), 25.0  # mm


def written(shipped, **errors):
    """True cameras of 400 training and 8 held-out views, and what is written down of them."""
    settings = replace(shipped, count=400, calibration=replace(shipped.calibration, **errors))
    cameras, held_out = cameras_around(CENTRE, RADIUS, settings)
    draws = draws_of(0, "part", settings)
    found = recorded(cameras, held_out, CENTRE, settings.calibration, draws)
    np.testing.assert_array_equal(found.K[400:], cameras.K[400:])
    np.testing.assert_array_equal(found.c2w[400:], cameras.c2w[400:])
    return cameras[np.arange(400)], found[np.arange(400)]


def rms(values: np.ndarray) -> float:
    return float(np.sqrt((values**2).mean()))


def test_without_error_the_true_cameras_are_recorded(shipped):
    cameras, held_out = cameras_around(CENTRE, RADIUS, shipped)
    draws = draws_of(0, "part", shipped)
    assert is_exact(shipped.calibration)
    assert recorded(cameras, held_out, CENTRE, shipped.calibration, draws) is cameras


def test_axes_are_off_by_the_angle_asked_for(shipped):
    """The r.m.s. of 400 normal draws is known to 3.5 %; five times that is chance once in 1e6."""
    true, found = written(shipped, rotation_deg=2.0)
    turn = found.c2w[:, :3, :3] @ np.swapaxes(true.c2w[:, :3, :3], 1, 2)
    np.testing.assert_allclose(np.linalg.det(turn), 1, rtol=0, atol=1e-12)
    angle = np.degrees(np.arccos(np.clip((np.trace(turn, axis1=1, axis2=2) - 1) / 2, -1, 1)))
    assert rms(angle) == pytest.approx(2.0, rel=0.18)
    np.testing.assert_array_equal(found.eyes, true.eyes)
    np.testing.assert_array_equal(found.K, true.K)
    # no axis is preferred: the turns' mean vector is 0 to 2 / sqrt(3) / sqrt(400) a coordinate
    vector = np.degrees(np.stack([turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0]]))
    assert np.abs(vector.mean(axis=1) / 2).max() < 5 * 2 / np.sqrt(3 * 400)


def test_eyes_are_off_by_the_share_of_the_distance_asked_for(shipped):
    """1200 coordinates: known to 2 %, five times that is chance once in 1e6."""
    true, found = written(shipped, position=0.03)
    off = np.linalg.norm(found.eyes - true.eyes, axis=1)
    assert rms(off) == pytest.approx(0.03 * shipped.radius * RADIUS, rel=0.1)
    np.testing.assert_array_equal(found.c2w[:, :3, :3], true.c2w[:, :3, :3])


def test_focal_lengths_are_off_by_the_share_asked_for(shipped):
    true, found = written(shipped, focal=0.05)
    change = found.K[:, 0, 0] / true.K[:, 0, 0]
    assert rms(np.log(change)) == pytest.approx(0.05, rel=0.18)
    np.testing.assert_array_equal(found.K[:, 0, 0], found.K[:, 1, 1])
    np.testing.assert_array_equal(found.K[:, :2, 2], true.K[:, :2, 2])
    assert change.min() > 0


def test_a_larger_error_is_the_same_error_enlarged(shipped):
    """Sweeps over an error compare like with like."""
    true, small = written(shipped, position=0.01)
    _, large = written(shipped, position=0.02)
    off = large.eyes - true.eyes
    np.testing.assert_allclose(off, 2 * (small.eyes - true.eyes), rtol=0, atol=1e-10)
