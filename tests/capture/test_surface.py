"""What a ray meets: faces have the side that is seen, and facets stand for a round surface."""

import numpy as np
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.capture.surface import Surface

RADIUS = 10.0
EYE = np.array([50.0, 0, 0])


def looked_at(solid: trimesh.Trimesh, crease_deg: float, count: int = 1000):
    mesh = Mesh.plain(np.array(solid.vertices, float), np.array(solid.faces, np.int32))
    rng, surface = np.random.default_rng(0), Surface(mesh, crease_deg)
    aims = np.stack([np.zeros(count), *rng.uniform(-6, 6, (2, count))], axis=1)
    directions = (aims - EYE).astype(np.float32)
    spots = surface.look(EYE, directions)
    return surface, spots, EYE + spots.t[:, None] * directions[spots.ray]


def test_spots_are_lifted_from_facets_towards_the_ball_and_not_beyond():
    """A facet whose corners are seen from its middle at the angle a lies 1 - cos a below.

    The feet of its middle on the corners' tangent planes lie sqrt(1 + sin^2 a cos^2 a) - 1 above
    the ball, which is as much to the first order, and so does their mean.
    """
    surface, spots, at = looked_at(trimesh.creation.icosphere(2, RADIUS), 40.0)
    lifted = np.linalg.norm(surface.lifted(spots), axis=1) / RADIUS
    facet = np.linalg.norm(at, axis=1) / RADIUS
    deepest = 1 - facet.min()
    assert deepest > 0.01
    assert (lifted > facet - 1e-5).all()  # float32 of rays 50 mm long
    assert lifted.min() > 1 - 1e-3
    assert lifted.max() < 1 + 1.1 * deepest


def test_flat_faces_lift_nothing():
    surface, spots, at = looked_at(trimesh.creation.box((20, 20, 20)), 30.0)
    np.testing.assert_allclose(surface.lifted(spots), at, rtol=0, atol=1e-4)


def test_the_back_of_a_face_is_lifted_to_its_own_side():
    """Into a bowl, the inside of the ball turned inside out, nothing rises: it is hollow."""
    ball = trimesh.creation.icosphere(2, RADIUS)
    ball.invert()
    surface, spots, at = looked_at(ball, 40.0)
    assert spots.turned.all()
    assert (np.einsum("in,ni->n", spots.normal, EYE - at) > 0).all()
    assert (np.linalg.norm(surface.lifted(spots), axis=1) > 0.998 * RADIUS).all()


def test_normals_of_seen_faces_look_at_the_eye():
    _, spots, at = looked_at(trimesh.creation.box((20, 20, 20)), 30.0)
    assert not spots.turned.any()
    np.testing.assert_allclose(spots.normal, np.tile([[1], [0], [0]], len(at)), rtol=0, atol=1e-6)
