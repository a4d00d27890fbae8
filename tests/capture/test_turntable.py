"""A turntable's cameras: elevations exact, evenly round, held-out ones in the gaps."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.capture.rigs import bounding_ball, cameras_around, directions
from industnerf.capture.turntable import held_out_directions, ring_directions, split_evenly
from industnerf.geometry.cameras import common_view_ball

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
