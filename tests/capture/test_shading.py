"""Light on a matte part: Lambert's law, from wherever it is seen, in the colour of its faces."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.finish import UNSTATED, Finish
from industnerf.artifacts.part import Mesh
from industnerf.capture.light import Lamps
from industnerf.capture.materials import Materials
from industnerf.capture.shading import Matte
from industnerf.capture.surface import Surface
from industnerf.errors import BadArtifact
from industnerf.geometry.sphere import fibonacci_sphere

SQUARE = Mesh.plain(
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


class Shown:
    """A matte part of one finish in `light`."""

    def __init__(self, mesh: Mesh, light) -> None:
        self.surface = Surface(mesh, 30.0)
        self._shade = Matte(Materials.of(mesh, [UNSTATED], [0.5, 0.5, 0.5]), Lamps.of(light))

    def look(self, eye: np.ndarray, directions: np.ndarray):
        """Which rays hit, at which t, and the light that they see."""
        spots = self.surface.look(eye, directions)
        (light,) = self._shade(spots)
        return spots.ray, spots.t, light


def towards(eye: np.ndarray, points: np.ndarray) -> np.ndarray:
    return (points - eye).astype(np.float32)


def test_a_face_is_as_bright_as_its_normal_says(shipped, as_mesh):
    box = trimesh.creation.box((20, 30, 40))
    shown = Shown(as_mesh(box), shipped.light)
    for outward in np.vstack([np.eye(3), -np.eye(3)]):
        eye = 100 * outward
        _, _, found = shown.look(eye, towards(eye, np.array([[1.0, 2, 3]])))
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
    shown = Shown(as_mesh(trimesh.creation.icosphere(subdivisions=4)), shipped.light)
    normals = fibonacci_sphere(500)
    found = np.concatenate(
        [shown.look(3 * n, towards(3 * n, np.zeros((1, 3))))[2] for n in normals]
    )
    # corner normals of the ball are right to 0.01 rad (see the test of normals)
    tolerance = 0.01 * sum(shipped.light.intensities)
    np.testing.assert_allclose(found, lambert(normals, shipped.light), rtol=0, atol=tolerance)


def test_a_point_is_as_bright_from_every_eye_that_sees_it(shipped, as_mesh):
    """Photo-consistency, on a part with flat, round, outer and inner surfaces."""
    ring = trimesh.creation.annulus(5, 10, 4, sections=64)
    shown, rng = Shown(as_mesh(ring), shipped.light), np.random.default_rng(0)
    triangles = np.array(ring.triangles)
    # well inside the faces: on a crease two eyes may meet either of its faces
    weights = 0.05 + 0.85 * rng.dirichlet([1, 1, 1], len(triangles))
    points = np.einsum("mi,mij->mj", weights, triangles)
    seen = np.full((12, len(points)), np.nan)
    for row, eye in zip(seen, 40 * fibonacci_sphere(12), strict=True):
        ray, t, light = shown.look(eye, towards(eye, points))
        meets = np.abs(t - 1) < 1e-5  # the point itself, nothing before it
        row[ray[meets]] = light[meets]
    twice = np.isfinite(seen).sum(axis=0) > 1
    assert twice.mean() > 0.5
    spread = np.nanmax(seen[:, twice], axis=0) - np.nanmin(seen[:, twice], axis=0)
    # float32, 40 mm away, meets a point to some 1e-5 mm, and to 1e-3 mm where the ray grazes; the
    # normal turns by 0.2 rad per mm in the bore
    assert spread.max() < 0.2 * 1e-3 * sum(shipped.light.intensities)


def test_a_sheet_is_lit_on_the_side_that_is_seen(shipped):
    shown = Shown(SQUARE, shipped.light)
    for up in (1.0, -1.0):
        eye = np.array([0, 0, 5 * up])
        _, _, found = shown.look(eye, towards(eye, np.array([[0.3, 0.2, 0]])))
        expected = lambert(np.array([[0, 0, up]]), shipped.light)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6)


def test_how_a_face_is_turned_does_not_matter(shipped):
    turned = Mesh.plain(SQUARE.vertices, SQUARE.faces[:, ::-1].copy())
    eye, at = np.array([1.0, 2, 5]), np.array([[0.3, 0.2, 0]])
    one, other = (
        Shown(mesh, shipped.light).look(eye, towards(eye, at))[2] for mesh in (SQUARE, turned)
    )
    np.testing.assert_array_equal(one, other)


def test_where_there_is_no_part_nothing_is_met(shipped):
    eye = np.array([0.0, 0, 5])
    at = np.array([[3.0, 0, 0], [0, 0, 0], [0, 3, 0]])
    ray, _, light = Shown(SQUARE, shipped.light).look(eye, towards(eye, at))
    np.testing.assert_array_equal(ray, [1])
    assert light > 0


def test_without_lamps_all_is_ambient(shipped):
    light = replace(shipped.light, ambient=0.7, directions=[], intensities=[])
    eye = np.array([0.0, 0, 5])
    _, _, found = Shown(SQUARE, light).look(eye, towards(eye, np.zeros((1, 3))))
    assert found[0] == np.float32(0.7)


def test_the_shipped_light_lights_every_side_and_saturates_none(shipped):
    value = lambert(fibonacci_sphere(5000), shipped.light)
    assert value.min() * max(shipped.albedo) > 0.1
    assert value.max() * max(shipped.albedo) < 1


# --- finishes --------------------------------------------------------------------------------

RED, BLUE = Finish("red", (0.7, 0.2, 0.1), 0.0, 1.0), Finish("blue", (0.1, 0.2, 0.8), 0.0, 1.0)


def painted(*of_face: int) -> Mesh:
    """The square, whose two faces have these finishes."""
    return Mesh(SQUARE.vertices, SQUARE.faces, np.array(of_face, np.uint8))


def test_each_face_has_the_colour_of_its_finish_times_the_light(shipped):
    mesh, eye = painted(1, 0), np.array([0.0, 0, 5])
    shade = Matte(Materials.of(mesh, [BLUE, RED], shipped.albedo), Lamps.of(shipped.light))
    below, above = np.array([[0.5, -0.5, 0]]), np.array([[-0.5, 0.5, 0]])  # of the diagonal
    spots = Surface(mesh, 30.0).look(eye, towards(eye, np.vstack([below, above])))
    light = lambert(np.array([[0, 0, 1.0]]), shipped.light)[0]
    expected = light * np.array([RED.albedo, BLUE.albedo]).T
    np.testing.assert_allclose(shade(spots), expected, rtol=0, atol=1e-6)
    assert shade.tint == (1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("finishes", "of_face", "tint"),
    [
        ([RED], (0, 0), RED.albedo),
        ([RED, BLUE], (0, 0), RED.albedo),  # blue is listed, but no face has it
        ([RED, RED], (0, 1), RED.albedo),
        ([UNSTATED], (0, 0), (0.1, 0.2, 0.3)),  # views.albedo
        ([UNSTATED, RED], (1, 1), RED.albedo),
    ],
)
def test_a_part_of_one_colour_has_one_channel_and_its_tint(shipped, finishes, of_face, tint):
    mesh, eye = painted(*of_face), np.array([0.0, 0, 5])
    shade = Matte(Materials.of(mesh, finishes, [0.1, 0.2, 0.3]), Lamps.of(shipped.light))
    spots = Surface(mesh, 30.0).look(eye, towards(eye, np.array([[0.3, 0.2, 0]])))
    assert shade(spots).shape == (1, 1)
    assert shade.tint == tint


def test_a_finish_that_is_not_listed_is_refused():
    with pytest.raises(BadArtifact, match=r"finish 2, but part\.json lists 2"):
        Materials.of(painted(0, 2), [RED, BLUE], [0.5] * 3)


def test_a_change_of_finish_is_no_crease():
    """Normals, and so shading, know nothing of colours."""
    plain, two = (
        Surface(mesh, 30.0).look(np.array([1.0, 2, 5]), np.array([[-0.2, -0.4, -1]], np.float32))
        for mesh in (painted(0, 0), painted(0, 1))
    )
    np.testing.assert_array_equal(plain.normal, two.normal)
