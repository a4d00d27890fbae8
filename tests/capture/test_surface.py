"""Light on a matte part: Lambert's law, from wherever it is seen."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.capture.edges import BACKGROUND
from industnerf.capture.surface import Lamps, Surface
from industnerf.geometry.sphere import fibonacci_sphere

SQUARE = Mesh(
    np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]),
    np.array([[0, 1, 2], [0, 2, 3]], np.int32),
)


def lambert(normals: np.ndarray, light) -> np.ndarray:
    """The law in float64, lamp by lamp."""
    value = np.full(len(normals), light.ambient)
    for towards, intensity in zip(light.directions, light.intensities, strict=True):
        cosine = normals @ towards / np.linalg.norm(towards)
        value += intensity * np.maximum(cosine, 0)
    return value


def towards(eye: np.ndarray, points: np.ndarray) -> np.ndarray:
    return (points - eye).astype(np.float32)


def test_a_face_is_as_bright_as_its_normal_says(shipped, as_mesh):
    box = trimesh.creation.box((20, 30, 40))
    surface = Surface(as_mesh(box), 30.0, shipped.light)
    for outward in np.vstack([np.eye(3), -np.eye(3)]):
        eye = 100 * outward
        found = surface.light_along(eye, towards(eye, np.array([[1.0, 2, 3]])))
        # float32: 1e-7 in each of some ten operations
        assert found[0] == pytest.approx(lambert(outward[None], shipped.light)[0], abs=1e-6)


def test_the_length_of_a_normal_does_not_matter(shipped):
    """Between corners, interpolated normals are shorter than 1."""
    normals, lamps = fibonacci_sphere(50), Lamps.of(shipped.light)
    for length in (0.2, 1, 3):
        found = lamps.shine((length * normals).T.astype(np.float32))
        np.testing.assert_allclose(found, lambert(normals, shipped.light), rtol=0, atol=1e-6)


def test_a_ball_is_shaded_as_a_ball_and_not_as_its_facets(shipped, as_mesh):
    """Its facets, of up to 0.05 rad, would differ by as much times the lamps' intensities."""
    surface = Surface(as_mesh(trimesh.creation.icosphere(subdivisions=4)), 30.0, shipped.light)
    normals = fibonacci_sphere(500)
    found = np.concatenate(
        [surface.light_along(3 * n, towards(3 * n, np.zeros((1, 3)))) for n in normals]
    )
    # corner normals of the ball are right to 0.01 rad (see the test of normals)
    tolerance = 0.01 * sum(shipped.light.intensities)
    np.testing.assert_allclose(found, lambert(normals, shipped.light), rtol=0, atol=tolerance)


def test_a_point_is_as_bright_from_every_eye_that_sees_it(shipped, as_mesh):
    """Photo-consistency, on a part with flat, round, outer and inner surfaces."""
    ring = trimesh.creation.annulus(5, 10, 4, sections=64)
    surface, rng = Surface(as_mesh(ring), 30.0, shipped.light), np.random.default_rng(0)
    triangles = np.array(ring.triangles)
    # well inside the faces: on a crease two eyes may meet either of its faces
    weights = 0.05 + 0.85 * rng.dirichlet([1, 1, 1], len(triangles))
    points = np.einsum("mi,mij->mj", weights, triangles)
    seen = np.full((12, len(points)), np.nan)
    for row, eye in zip(seen, 40 * fibonacci_sphere(12), strict=True):
        look = surface.look(eye, towards(eye, points))
        meets = np.abs(look.t - 1) < 1e-5  # the point itself, nothing before it
        row[look.ray[meets]] = look.light[meets]
    twice = np.isfinite(seen).sum(axis=0) > 1
    assert twice.mean() > 0.5
    spread = np.nanmax(seen[:, twice], axis=0) - np.nanmin(seen[:, twice], axis=0)
    # float32, 40 mm away, meets a point to some 1e-5 mm, and to 1e-3 mm where the ray grazes; the
    # normal turns by 0.2 rad per mm in the bore
    assert spread.max() < 0.2 * 1e-3 * sum(shipped.light.intensities)


def test_a_sheet_is_lit_on_the_side_that_is_seen(shipped):
    surface = Surface(SQUARE, 30.0, shipped.light)
    for up in (1.0, -1.0):
        eye = np.array([0, 0, 5 * up])
        found = surface.light_along(eye, towards(eye, np.array([[0.3, 0.2, 0]])))
        expected = lambert(np.array([[0, 0, up]]), shipped.light)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6)


def test_how_a_face_is_turned_does_not_matter(shipped):
    turned = Mesh(SQUARE.vertices, SQUARE.faces[:, ::-1].copy())
    eye, at = np.array([1.0, 2, 5]), np.array([[0.3, 0.2, 0]])
    one, other = (
        Surface(mesh, 30.0, shipped.light).light_along(eye, towards(eye, at))
        for mesh in (SQUARE, turned)
    )
    np.testing.assert_array_equal(one, other)


def test_where_there_is_no_part_there_is_background(shipped):
    eye = np.array([0.0, 0, 5])
    found = Surface(SQUARE, 30.0, shipped.light).light_along(
        eye, towards(eye, np.array([[0.0, 0, 0], [3, 0, 0]]))
    )
    assert found[0] > 0
    assert found[1] == BACKGROUND


def test_without_lamps_all_is_ambient(shipped):
    light = replace(shipped.light, ambient=0.7, directions=[], intensities=[])
    eye = np.array([0.0, 0, 5])
    found = Surface(SQUARE, 30.0, light).light_along(eye, towards(eye, np.zeros((1, 3))))
    assert found[0] == np.float32(0.7)


def test_the_shipped_light_lights_every_side_and_saturates_none(shipped):
    value = lambert(fibonacci_sphere(5000), shipped.light)
    assert value.min() * max(shipped.albedo) > 0.1
    assert value.max() * max(shipped.albedo) < 1
