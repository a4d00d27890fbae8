"""Recorded cameras are wrong by as much as asked, training cameras alone."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.capture.calibration_error import is_exact, perturbed_cameras
from industnerf.capture.rigs import cameras_around
from industnerf.capture.rng import random_streams

CENTER, RADIUS = np.array([100.0, -20, 7]), 25.0  # mm


def recorded_cameras(shipped, **errors):
    """True cameras of 400 training and 8 held-out views, and what is written down of them."""
    settings = replace(shipped, count=400, calibration=replace(shipped.calibration, **errors))
    cameras, held_out = cameras_around(CENTER, RADIUS, settings)
    view_streams = random_streams(0, "part", settings)
    perturbed = perturbed_cameras(cameras, held_out, CENTER, settings.calibration, view_streams)
    np.testing.assert_array_equal(perturbed.K[400:], cameras.K[400:])
    np.testing.assert_array_equal(perturbed.c2w[400:], cameras.c2w[400:])
    return cameras[np.arange(400)], perturbed[np.arange(400)]


def rms(values: np.ndarray) -> float:
    return float(np.sqrt((values**2).mean()))


def test_without_error_the_true_cameras_are_recorded(shipped):
    cameras, held_out = cameras_around(CENTER, RADIUS, shipped)
    view_streams = random_streams(0, "part", shipped)
    assert is_exact(shipped.calibration)
    assert (
        perturbed_cameras(cameras, held_out, CENTER, shipped.calibration, view_streams) is cameras
    )


def test_axes_are_off_by_the_angle_asked_for(shipped):
    """The r.m.s. of 400 normal draws is known to 3.5 %; five times that is chance once in 1e6."""
    true, perturbed = recorded_cameras(shipped, rotation_deg=2.0)
    rotation = perturbed.c2w[:, :3, :3] @ np.swapaxes(true.c2w[:, :3, :3], 1, 2)
    np.testing.assert_allclose(np.linalg.det(rotation), 1, rtol=0, atol=1e-12)
    angle = np.degrees(np.arccos(np.clip((np.trace(rotation, axis1=1, axis2=2) - 1) / 2, -1, 1)))
    assert rms(angle) == pytest.approx(2.0, rel=0.18)
    np.testing.assert_array_equal(perturbed.centers, true.centers)
    np.testing.assert_array_equal(perturbed.K, true.K)
    # no axis is preferred: the turns' mean vector is 0 to 2 / sqrt(3) / sqrt(400) a coordinate
    vector = np.degrees(
        np.stack([rotation[:, 2, 1] - rotation[:, 1, 2], rotation[:, 0, 2] - rotation[:, 2, 0]])
    )
    assert np.abs(vector.mean(axis=1) / 2).max() < 5 * 2 / np.sqrt(3 * 400)


def test_eyes_are_off_by_the_share_of_the_distance_asked_for(shipped):
    """1200 coordinates: known to 2 %, five times that is chance once in 1e6."""
    true, perturbed = recorded_cameras(shipped, position=0.03)
    off = np.linalg.norm(perturbed.centers - true.centers, axis=1)
    assert rms(off) == pytest.approx(0.03 * shipped.radius * RADIUS, rel=0.1)
    np.testing.assert_array_equal(perturbed.c2w[:, :3, :3], true.c2w[:, :3, :3])


def test_focal_lengths_are_off_by_the_share_asked_for(shipped):
    true, perturbed = recorded_cameras(shipped, focal=0.05)
    change = perturbed.K[:, 0, 0] / true.K[:, 0, 0]
    assert rms(np.log(change)) == pytest.approx(0.05, rel=0.18)
    np.testing.assert_array_equal(perturbed.K[:, 0, 0], perturbed.K[:, 1, 1])
    np.testing.assert_array_equal(perturbed.K[:, :2, 2], true.K[:, :2, 2])
    assert change.min() > 0


def test_a_larger_error_is_the_same_error_enlarged(shipped):
    """Sweeps over an error compare like with like."""
    true, small = recorded_cameras(shipped, position=0.01)
    _, large = recorded_cameras(shipped, position=0.02)
    off = large.centers - true.centers
    np.testing.assert_allclose(off, 2 * (small.centers - true.centers), rtol=0, atol=1e-10)
