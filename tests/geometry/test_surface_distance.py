"""Distances to a surface against closed forms and against every triangle in turn."""

import numpy as np
import pytest
import trimesh

from industnerf.geometry.surface_distance import distance_to_surface


def to_box(points, half):
    """Distance to the surface of the cube of half side `half` about the origin."""
    beyond = np.abs(points) - half
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    return np.where(outside > 0, outside, -beyond.max(axis=1))


def to_triangles(points, triangles):
    """The same for any triangles, one by one, in float64: trimesh's closed form."""
    nearest = np.full(len(points), np.inf)
    for triangle in triangles:
        again = np.broadcast_to(triangle, (len(points), 3, 3))
        foot = trimesh.triangles.closest_point(again, points)
        nearest = np.minimum(nearest, np.linalg.norm(points - foot, axis=1))
    return nearest


@pytest.fixture
def points():
    return np.random.default_rng(0).normal(size=(500, 3)) * 20


def test_distance_to_a_box_from_inside_and_outside(points):
    box = trimesh.creation.box([30.0] * 3)
    distances = distance_to_surface(points, box.vertices, box.faces)
    # float32 at coordinates of up to 80: 2^-24 of that, a few times over
    np.testing.assert_allclose(distances, to_box(points, 15.0), rtol=0, atol=3e-5)


def test_far_from_the_origin_nothing_is_lost(points):
    # float32 alone would round to 0.06 there
    box, offset = trimesh.creation.box([30.0] * 3), np.array([1e6, -1e6, 1e6])
    distances = distance_to_surface(points + offset, box.vertices + offset, box.faces)
    np.testing.assert_allclose(distances, to_box(points, 15.0), rtol=0, atol=3e-5)


def test_any_triangles_do_closed_or_not(points):
    rng = np.random.default_rng(1)
    vertices = rng.normal(size=(60, 3)) * 10
    faces = np.arange(60, dtype=np.int32).reshape(20, 3)
    distances = distance_to_surface(points, vertices, faces)
    np.testing.assert_allclose(distances, to_triangles(points, vertices[faces]), rtol=0, atol=3e-5)


def test_a_point_however_far_has_a_distance():
    box, far = trimesh.creation.box([1.0] * 3), np.array([[1e6, 0.0, 0.0]])
    assert distance_to_surface(far, box.vertices, box.faces)[0] == pytest.approx(1e6, rel=1e-6)


def test_of_no_points_there_are_no_distances():
    box = trimesh.creation.box([1.0] * 3)
    assert distance_to_surface(np.zeros((0, 3)), box.vertices, box.faces).shape == (0,)
