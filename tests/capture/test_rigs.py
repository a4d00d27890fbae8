"""Cameras frame the part, and held-out views are new views."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.capture.rigs import best_azimuth_offset, bounding_ball, cameras_around
from industnerf.errors import BadParams
from industnerf.geometry.cameras import common_view_ball, project
from industnerf.geometry.sphere import fibonacci_hemisphere, fibonacci_sphere

CENTER = np.array([100.0, -20, 7])


def smallest_angle_deg(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.degrees(np.arccos(np.clip((a @ b.T).max(), -1, 1))))


def test_the_ball_of_a_box_is_its_diagonal():
    corners = np.array([[0.0, 0, 0], [2, 0, 0], [0, 3, 0], [0, 0, 6], [2, 3, 6]])
    center, radius = bounding_ball(corners)
    np.testing.assert_array_equal(center, [1, 1.5, 3])
    assert radius == pytest.approx(3.5, rel=1e-15)


def test_every_camera_has_the_whole_ball_in_frame(shipped):
    cameras, _ = cameras_around(CENTER, 25.0, shipped)
    ball = CENTER + 25 * fibonacci_sphere(2000)
    for K, c2w in zip(cameras.K, cameras.c2w, strict=True):
        uv, depth = project(ball, K, c2w)
        assert (uv > 0).all()
        assert (uv < shipped.resolution).all()
        assert depth.min() > (shipped.radius - 1.001) * 25
    center, framed = common_view_ball(cameras)
    np.testing.assert_allclose(center, CENTER, rtol=0, atol=1e-9)
    assert framed >= 25


def test_training_views_come_first(shipped):
    _, held_out = cameras_around(CENTER, 25.0, shipped)
    np.testing.assert_array_equal(held_out, [False] * shipped.count + [True] * shipped.held_out)


def test_held_out_views_are_new_views(shipped):
    """A shipped rig of 40 leaves gaps of about 30 degrees; 8 more need not touch its cameras."""
    cameras, held_out = cameras_around(np.zeros(3), 1.0, shipped)
    camera_centers = cameras.centers / shipped.radius
    assert smallest_angle_deg(camera_centers[~held_out], camera_centers[held_out]) > 5


def test_as_many_held_out_as_training_views_do_not_coincide(shipped):
    """Without a turn they would be the same views."""
    cameras, held_out = cameras_around(np.zeros(3), 1.0, replace(shipped, count=8, held_out=8))
    camera_centers = cameras.centers / shipped.radius
    assert smallest_angle_deg(camera_centers[~held_out], camera_centers[held_out]) > 20


@pytest.mark.parametrize("lattice", [fibonacci_sphere, fibonacci_hemisphere])
@given(st.integers(1, 60), st.integers(1, 12))
def test_they_are_new_views_of_any_rig(lattice, count, held_out):
    """Never nearer than without a turn; equal counts would coincide without it."""
    train = lattice(count)
    rotated = lattice(held_out, best_azimuth_offset(train, held_out, lattice))
    apart = smallest_angle_deg(train, rotated)
    assert apart >= smallest_angle_deg(train, lattice(held_out)) - 1e-6
    assert apart > 1


def test_no_held_out_views_are_none(shipped):
    cameras, held_out = cameras_around(CENTER, 1.0, replace(shipped, held_out=0))
    assert len(cameras) == shipped.count
    assert not held_out.any()


def test_a_part_out_of_frame_is_refused_and_what_is_missing_said(shipped):
    # asin(1/2) = 30 degrees on either side
    with pytest.raises(BadParams, match=r"60\.00 degrees, 30\.00 more than views\.fov_deg = 30"):
        cameras_around(CENTER, 1.0, replace(shipped, radius=2.0, fov_deg=30.0))


@pytest.mark.parametrize("change", [{"radius": 3.864}, {"fov_deg": 60.0}])
def test_turning_either_knob_as_told_helps(shipped, change):
    tight = replace(shipped, radius=2.0, fov_deg=30.0)
    with pytest.raises(BadParams, match=r"views\.radius to 3\.864 or views\.fov_deg to 60\.$"):
        cameras_around(CENTER, 1.0, tight)
    cameras_around(CENTER, 1.0, replace(tight, **change))


def test_a_part_that_just_does_not_fit_is_refused(shipped):
    with pytest.raises(BadParams, match=r"views\.radius to 3\.864"):
        cameras_around(CENTER, 1.0, replace(shipped, radius=3.863, fov_deg=30.0))


@pytest.mark.parametrize("radius", [0.0, 0.5, 1.0])
def test_a_camera_within_the_ball_is_refused(shipped, radius):
    with pytest.raises(BadParams, match=r"views\.radius"):
        cameras_around(CENTER, 1.0, replace(shipped, radius=radius))
