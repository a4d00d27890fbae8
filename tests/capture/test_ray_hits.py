"""What a ray meets: faces have the side that is seen, and facets stand for a round surface."""

import numpy as np
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.capture.ray_hits import Surface

RADIUS = 10.0
CAMERA_CENTER = np.array([50.0, 0, 0])


def intersected(solid: trimesh.Trimesh, crease_deg: float, count: int = 1000):
    mesh = Mesh.with_one_appearance(
        np.array(solid.vertices, float), np.array(solid.faces, np.int32)
    )
    rng, surface = np.random.default_rng(0), Surface(mesh, crease_deg)
    aims = np.stack([np.zeros(count), *rng.uniform(-6, 6, (2, count))], axis=1)
    directions = (aims - CAMERA_CENTER).astype(np.float32)
    hits = surface.intersect(CAMERA_CENTER, directions)
    return surface, hits, CAMERA_CENTER + hits.t[:, None] * directions[hits.ray]


def test_spots_are_lifted_from_facets_towards_the_ball_and_not_beyond():
    """A facet whose corners are seen from its middle at the angle a lies 1 - cos a below.

    The feet of its middle on the corners' tangent planes lie sqrt(1 + sin^2 a cos^2 a) - 1 above
    the ball, which is as much to the first order, and so does their mean.
    """
    surface, hits, at = intersected(trimesh.creation.icosphere(2, RADIUS), 40.0)
    offset_points = np.linalg.norm(surface.offset_along_normal(hits), axis=1) / RADIUS
    facet = np.linalg.norm(at, axis=1) / RADIUS
    deepest = 1 - facet.min()
    assert deepest > 0.01
    assert (offset_points > facet - 1e-5).all()  # float32 of rays 50 mm long
    assert offset_points.min() > 1 - 1e-3
    assert offset_points.max() < 1 + 1.1 * deepest


def test_flat_faces_lift_nothing():
    surface, hits, at = intersected(trimesh.creation.box((20, 20, 20)), 30.0)
    np.testing.assert_allclose(surface.offset_along_normal(hits), at, rtol=0, atol=1e-4)


def test_the_back_of_a_face_is_lifted_to_its_own_side():
    """Into a bowl, the inside of the ball turned inside out, nothing rises: it is hollow."""
    ball = trimesh.creation.icosphere(2, RADIUS)
    ball.invert()
    surface, hits, at = intersected(ball, 40.0)
    assert hits.is_backface.all()
    assert (np.einsum("in,ni->n", hits.normal, CAMERA_CENTER - at) > 0).all()
    assert (np.linalg.norm(surface.offset_along_normal(hits), axis=1) > 0.998 * RADIUS).all()


def test_normals_of_seen_faces_look_at_the_eye():
    _, hits, at = intersected(trimesh.creation.box((20, 20, 20)), 30.0)
    assert not hits.is_backface.any()
    np.testing.assert_allclose(hits.normal, np.tile([[1], [0], [0]], len(at)), rtol=0, atol=1e-6)
