"""Light on a matte part: Lambert's law, from wherever it is seen, in the color of its faces."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import UNSPECIFIED, Appearance, Mesh
from industnerf.capture.light import Lights
from industnerf.capture.materials import Materials
from industnerf.capture.ray_hits import Surface
from industnerf.capture.shading import LambertianShading
from industnerf.errors import BadArtifact
from industnerf.geometry.sphere import fibonacci_sphere

SQUARE = Mesh.with_one_appearance(
    np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]),
    np.array([[0, 1, 2], [0, 2, 3]], np.int32),
)


def lambert(normals: np.ndarray, light) -> np.ndarray:
    """The law in float64, lamp by lamp."""
    value = np.full(len(normals), light.ambient)
    for direction, intensity in zip(light.directions, light.intensities, strict=True):
        cosine = normals @ direction / np.linalg.norm(direction)
        value += intensity * np.maximum(cosine, 0)
    return value


class LambertianScene:
    """A matte part of one finish in `light`."""

    def __init__(self, mesh: Mesh, light) -> None:
        self.surface = Surface(mesh, 30.0)
        self._shade = LambertianShading(
            Materials.from_mesh(mesh, [UNSPECIFIED], [0.5, 0.5, 0.5]), Lights.from_params(light)
        )

    def trace(self, camera_center: np.ndarray, directions: np.ndarray):
        """Which rays hit, at which t, and the light that they see."""
        hits = self.surface.intersect(camera_center, directions)
        (light,) = self._shade(hits)
        return hits.ray, hits.t, light


def directions_to(camera_center: np.ndarray, points: np.ndarray) -> np.ndarray:
    return (points - camera_center).astype(np.float32)


def test_a_face_is_as_bright_as_its_normal_says(shipped, as_mesh):
    box = trimesh.creation.box((20, 30, 40))
    scene = LambertianScene(as_mesh(box), shipped.light)
    for outward in np.vstack([np.eye(3), -np.eye(3)]):
        camera_center = 100 * outward
        _, _, radiance = scene.trace(
            camera_center, directions_to(camera_center, np.array([[1.0, 2, 3]]))
        )
        # float32: 1e-7 in each of some ten operations
        assert radiance[0] == pytest.approx(lambert(outward[None], shipped.light)[0], abs=1e-6)


def test_the_length_of_a_normal_does_not_matter(shipped):
    """Between corners, interpolated normals are shorter than 1."""
    normals, lights = fibonacci_sphere(50), Lights.from_params(shipped.light)
    for length in (0.2, 1, 3):
        radiance = lights.shade((length * normals).T.astype(np.float32))
        np.testing.assert_allclose(radiance, lambert(normals, shipped.light), rtol=0, atol=1e-6)


def test_a_ball_is_shaded_as_a_ball_and_not_as_its_facets(shipped, as_mesh):
    """Its facets, of up to 0.05 rad, would differ by as much times the lamps' intensities."""
    scene = LambertianScene(as_mesh(trimesh.creation.icosphere(subdivisions=4)), shipped.light)
    normals = fibonacci_sphere(500)
    radiance = np.concatenate(
        [scene.trace(3 * n, directions_to(3 * n, np.zeros((1, 3))))[2] for n in normals]
    )
    # corner normals of the ball are right to 0.01 rad (see the test of normals)
    tolerance = 0.01 * sum(shipped.light.intensities)
    np.testing.assert_allclose(radiance, lambert(normals, shipped.light), rtol=0, atol=tolerance)


def test_a_point_is_as_bright_from_every_eye_that_sees_it(shipped, as_mesh):
    """Photo-consistency, on a part with flat, round, outer and inner surfaces."""
    ring = trimesh.creation.annulus(5, 10, 4, sections=64)
    scene, rng = LambertianScene(as_mesh(ring), shipped.light), np.random.default_rng(0)
    triangles = np.array(ring.triangles)
    # well inside the faces: on a crease two eyes may meet either of its faces
    weights = 0.05 + 0.85 * rng.dirichlet([1, 1, 1], len(triangles))
    points = np.einsum("mi,mij->mj", weights, triangles)
    radiance = np.full((12, len(points)), np.nan)
    for row, camera_center in zip(radiance, 40 * fibonacci_sphere(12), strict=True):
        ray, t, light = scene.trace(camera_center, directions_to(camera_center, points))
        is_hit = np.abs(t - 1) < 1e-5  # the point itself, nothing before it
        row[ray[is_hit]] = light[is_hit]
    twice = np.isfinite(radiance).sum(axis=0) > 1
    assert twice.mean() > 0.5
    spread = np.nanmax(radiance[:, twice], axis=0) - np.nanmin(radiance[:, twice], axis=0)
    # float32, 40 mm away, meets a point to some 1e-5 mm, and to 1e-3 mm where the ray grazes; the
    # normal turns by 0.2 rad per mm in the bore
    assert spread.max() < 0.2 * 1e-3 * sum(shipped.light.intensities)


def test_a_sheet_is_lit_on_the_side_that_is_seen(shipped):
    scene = LambertianScene(SQUARE, shipped.light)
    for up in (1.0, -1.0):
        camera_center = np.array([0, 0, 5 * up])
        _, _, radiance = scene.trace(
            camera_center, directions_to(camera_center, np.array([[0.3, 0.2, 0]]))
        )
        expected = lambert(np.array([[0, 0, up]]), shipped.light)
        np.testing.assert_allclose(radiance, expected, rtol=0, atol=1e-6)


def test_how_a_face_is_turned_does_not_matter(shipped):
    flipped = Mesh.with_one_appearance(SQUARE.vertices, SQUARE.faces[:, ::-1].copy())
    camera_center, at = np.array([1.0, 2, 5]), np.array([[0.3, 0.2, 0]])
    one, other = (
        LambertianScene(mesh, shipped.light).trace(camera_center, directions_to(camera_center, at))[
            2
        ]
        for mesh in (SQUARE, flipped)
    )
    np.testing.assert_array_equal(one, other)


def test_where_there_is_no_part_nothing_is_met(shipped):
    camera_center = np.array([0.0, 0, 5])
    at = np.array([[3.0, 0, 0], [0, 0, 0], [0, 3, 0]])
    ray, _, light = LambertianScene(SQUARE, shipped.light).trace(
        camera_center, directions_to(camera_center, at)
    )
    np.testing.assert_array_equal(ray, [1])
    assert light > 0


def test_without_lamps_all_is_ambient(shipped):
    light = replace(shipped.light, ambient=0.7, directions=[], intensities=[])
    camera_center = np.array([0.0, 0, 5])
    _, _, radiance = LambertianScene(SQUARE, light).trace(
        camera_center, directions_to(camera_center, np.zeros((1, 3)))
    )
    assert radiance[0] == np.float32(0.7)


def test_the_shipped_light_lights_every_side_and_saturates_none(shipped):
    value = lambert(fibonacci_sphere(5000), shipped.light)
    assert value.min() * max(shipped.albedo) > 0.1
    assert value.max() * max(shipped.albedo) < 1


# --- finishes --------------------------------------------------------------------------------

RED = Appearance("red", (0.7, 0.2, 0.1), 0.0, 1.0)
BLUE = Appearance("blue", (0.1, 0.2, 0.8), 0.0, 1.0)


def colored_square(*face_appearance: int) -> Mesh:
    """The square, whose two faces have these finishes."""
    return Mesh(SQUARE.vertices, SQUARE.faces, np.array(face_appearance, np.uint8))


def test_each_face_has_the_color_of_its_finish_times_the_light(shipped):
    mesh, camera_center = colored_square(1, 0), np.array([0.0, 0, 5])
    shade = LambertianShading(
        Materials.from_mesh(mesh, [BLUE, RED], shipped.albedo), Lights.from_params(shipped.light)
    )
    below, above = np.array([[0.5, -0.5, 0]]), np.array([[-0.5, 0.5, 0]])  # of the diagonal
    hits = Surface(mesh, 30.0).intersect(
        camera_center, directions_to(camera_center, np.vstack([below, above]))
    )
    light = lambert(np.array([[0, 0, 1.0]]), shipped.light)[0]
    expected = light * np.array([RED.albedo, BLUE.albedo]).T
    np.testing.assert_allclose(shade(hits), expected, rtol=0, atol=1e-6)
    assert shade.tint == (1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("appearances", "face_appearance", "tint"),
    [
        ([RED], (0, 0), RED.albedo),
        ([RED, BLUE], (0, 0), RED.albedo),  # blue is listed, but no face has it
        ([RED, RED], (0, 1), RED.albedo),
        ([UNSPECIFIED], (0, 0), (0.1, 0.2, 0.3)),  # views.albedo
        ([UNSPECIFIED, RED], (1, 1), RED.albedo),
    ],
)
def test_a_part_of_one_color_has_one_channel_and_its_tint(
    shipped, appearances, face_appearance, tint
):
    mesh, camera_center = colored_square(*face_appearance), np.array([0.0, 0, 5])
    shade = LambertianShading(
        Materials.from_mesh(mesh, appearances, [0.1, 0.2, 0.3]), Lights.from_params(shipped.light)
    )
    hits = Surface(mesh, 30.0).intersect(
        camera_center, directions_to(camera_center, np.array([[0.3, 0.2, 0]]))
    )
    assert shade(hits).shape == (1, 1)
    assert shade.tint == tint


def test_a_finish_that_is_not_listed_is_refused():
    with pytest.raises(BadArtifact, match=r"finish 2, but part\.json lists 2"):
        Materials.from_mesh(colored_square(0, 2), [RED, BLUE], [0.5] * 3)


def test_a_change_of_finish_is_no_crease():
    """Normals, and so shading, know nothing of colors."""
    one_appearance, two = (
        Surface(mesh, 30.0).intersect(
            np.array([1.0, 2, 5]), np.array([[-0.2, -0.4, -1]], np.float32)
        )
        for mesh in (colored_square(0, 0), colored_square(0, 1))
    )
    np.testing.assert_array_equal(one_appearance.normal, two.normal)
