"""Cameras frame the part, and held-out views are new views."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.capture.rigs import (
    best_azimuth_offset,
    bounding_ball,
    cameras_around,
    directions,
    held_out_directions,
    ring_directions,
    split_evenly,
)
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


ELEVATIONS = st.lists(st.floats(-1.4, 1.4), min_size=1, max_size=5).map(np.array)
COUNTS = st.integers(1, 60)


def azimuths(vectors: np.ndarray) -> np.ndarray:
    """In turns, sorted."""
    return np.sort(np.arctan2(vectors[:, 1], vectors[:, 0]) / (2 * np.pi) % 1)


def ring_by_ring(vectors: np.ndarray, levels: int) -> list[np.ndarray]:
    return np.split(vectors, np.cumsum(split_evenly(len(vectors), levels))[:-1])


@given(COUNTS, st.integers(1, 7))
def test_rings_share_cameras_as_evenly_as_can_be(count, levels):
    parts = split_evenly(count, levels)
    assert sum(parts) == count
    assert max(parts) - min(parts) <= 1


@given(COUNTS, ELEVATIONS)
def test_every_camera_is_at_the_elevation_of_its_ring(count, elevations):
    for vectors in (
        ring_directions(count, elevations),
        held_out_directions(count, count, elevations),
    ):
        expected = np.repeat(elevations, split_evenly(count, len(elevations)))
        # near the pole arcsin loses half the digits
        np.testing.assert_allclose(np.arcsin(vectors[:, 2]), expected, rtol=0, atol=1e-7)
        np.testing.assert_allclose(np.linalg.norm(vectors, axis=1), 1, rtol=0, atol=1e-15)


@given(COUNTS, ELEVATIONS)
def test_a_ring_is_evenly_spaced(count, elevations):
    for ring in ring_by_ring(ring_directions(count, elevations), len(elevations)):
        gaps = np.diff(azimuths(ring))
        np.testing.assert_allclose(gaps, 1 / max(len(ring), 1), rtol=0, atol=1e-12)


def test_rings_are_turned_against_each_other():
    """Three rings of four: a twelfth of a turn apart."""
    vectors = ring_directions(12, np.radians([-30.0, 10, 50]))
    np.testing.assert_allclose(azimuths(vectors), np.arange(12) / 12, rtol=0, atol=1e-12)


@given(COUNTS, st.integers(1, 20), ELEVATIONS)
def test_held_out_cameras_are_as_far_along_their_ring_as_gaps_allow(count, held_out, elevations):
    levels = len(elevations)
    train = ring_by_ring(ring_directions(count, elevations), levels)
    new = ring_by_ring(held_out_directions(count, held_out, elevations), levels)
    for old, ring in zip(train, new, strict=True):
        if not (len(old) and len(ring)):
            continue
        apart = np.abs(azimuths(ring)[:, None] - azimuths(old)[None])
        nearest = np.minimum(apart, 1 - apart).min(axis=1)
        slots = -(-len(ring) // len(old))  # a gap
        assert (nearest > 1 / (slots + 1) / len(old) - 1e-9).all()
        assert len(np.unique(azimuths(ring).round(9))) == len(ring)


def test_one_held_out_camera_a_gap_stands_in_its_middle():
    train = ring_by_ring(ring_directions(40, np.radians([-30.0, 10, 50])), 3)
    new = ring_by_ring(held_out_directions(40, 8, np.radians([-30.0, 10, 50])), 3)
    for old, ring in zip(train, new, strict=True):
        apart = np.abs(azimuths(ring)[:, None] - azimuths(old)[None])
        nearest = np.minimum(apart, 1 - apart).min(axis=1)
        np.testing.assert_allclose(nearest, 0.5 / len(old), rtol=0, atol=1e-12)


def test_held_out_cameras_stand_all_round():
    """Each third of a turn has two or three of eight."""
    at = azimuths(held_out_directions(40, 8, np.radians([-30.0, 10, 50])))
    counts = np.histogram(at, bins=3, range=(0, 1))[0]
    assert counts.min() >= 2


@pytest.mark.parametrize("rig", ["turntable", "hemisphere"])
def test_other_rigs_frame_the_part_as_the_sphere_does(shipped, rig):
    center, radius = bounding_ball(np.array([[0.0, 0, 0], [20, 30, 60]]))
    cameras, held_out = cameras_around(center, radius, replace(shipped, rig=rig))
    np.testing.assert_array_equal(held_out, np.arange(48) >= 40)
    np.testing.assert_allclose(
        np.linalg.norm(cameras.centers - center, axis=1), shipped.radius * radius, rtol=1e-12
    )
    all_cameras, framed = common_view_ball(cameras)
    np.testing.assert_allclose(all_cameras, center, rtol=0, atol=1e-9)
    assert framed >= radius


def test_a_hemisphere_looks_down_on_the_part_from_all_round(shipped):
    train, held_out = directions(replace(shipped, rig="hemisphere"))
    both = np.vstack([train, held_out])
    assert both[:, 2].min() > 0
    # even in area: the heights of 40 cameras are those of 40 rings of equal area
    np.testing.assert_allclose(train[:, 2], 1 - (np.arange(40) + 0.5) / 40, rtol=0, atol=1e-12)
    nearest = np.degrees(np.arccos((train @ held_out.T).max(axis=0)))
    assert nearest.min() > 5


def test_a_ring_near_the_pole_is_no_error(shipped):
    cameras, _ = cameras_around(
        np.zeros(3), 1.0, replace(shipped, rig="turntable", elevations_deg=[89.9, -89.9])
    )
    assert np.isfinite(cameras.c2w).all()
