"""The nulls know the part's box and nothing else."""

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.methods import load_method
from industnerf.methods.base import Input, MethodInputs, Role
from industnerf.schema import SampleSettings
from tests.methods.solids import cameras_around

CORNERS = np.array([[90.0, -60, 0], [110, -60, 4], [100, -20, 6], [95, -50, 1]])
SETTINGS = SampleSettings(5000)


def cloud(name: str, vertices: np.ndarray) -> np.ndarray:
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    cameras = cameras_around(2, 8, 50.0)
    inputs = MethodInputs(
        name, cameras, cameras, {Input.OWN_MESH: Mesh.with_one_appearance(vertices, faces)}
    )
    return load_method(name).reconstruct(inputs, SETTINGS, None, 3).points_mm


def test_the_ball_is_about_the_center_of_the_box():
    radius = np.linalg.norm(cloud("ball", CORNERS) - [100, -40, 3], axis=1)
    np.testing.assert_allclose(radius, (20 + 40 + 6) / 3 / 2, rtol=1e-12)


def test_the_box_is_the_bounding_box():
    points = cloud("box", CORNERS)
    on_face = np.isclose(points, CORNERS.min(axis=0), atol=1e-12) | np.isclose(
        points, CORNERS.max(axis=0), atol=1e-12
    )
    assert on_face.any(axis=1).all()
    np.testing.assert_allclose(points.min(axis=0), CORNERS.min(axis=0), atol=1e-12)
    np.testing.assert_allclose(points.max(axis=0), CORNERS.max(axis=0), atol=1e-12)


@pytest.mark.parametrize("name", ["ball", "box"])
def test_nothing_but_the_box_matters(name):
    inner = np.vstack([CORNERS[:3], CORNERS[:3].mean(axis=0)])
    np.testing.assert_array_equal(cloud(name, CORNERS), cloud(name, inner))
    assert load_method(name).role is Role.NULL


def test_every_face_of_the_part_gets_its_share_of_points():
    ball = trimesh.creation.icosphere(2, 20.0)
    mesh = Mesh.with_one_appearance(np.array(ball.vertices, float), ball.faces.astype(np.int32))
    cameras = cameras_around(2, 8, 50.0)
    inputs = MethodInputs("oracle", cameras, cameras, {Input.OWN_MESH: mesh})
    points = load_method("oracle").reconstruct(inputs, SampleSettings(50_000), None, 3).points_mm
    # The solid is convex: a point on it lies in the plane that it is farthest out of.
    planes = np.einsum("ij,ij->i", ball.face_normals, ball.triangles[:, 0])
    beyond = points @ ball.face_normals.T - planes
    np.testing.assert_allclose(beyond.max(axis=1), 0, atol=1e-12)
    expected = 50_000 * ball.area_faces / ball.area
    z = (np.bincount(beyond.argmax(axis=1), minlength=320) - expected) / np.sqrt(expected)
    assert np.abs(z).max() < 4.5  # of 320 counts, by chance once in 400 seeds


def test_no_point_lies_on_surface_that_nobody_sees():
    """A cavity less than 1 % of the diagonal beneath the surface: its points would be counted."""
    outer, inner = trimesh.creation.box([20.0] * 3), trimesh.creation.box([19.6] * 3)
    vertices = np.vstack([outer.vertices, inner.vertices])
    faces = np.vstack([outer.faces, inner.faces[:, ::-1] + 8]).astype(np.int32)
    cameras = cameras_around(2, 8, 50.0)
    mesh = Mesh.with_one_appearance(vertices, faces)
    inputs = MethodInputs("oracle", cameras, cameras, {Input.OWN_MESH: mesh})
    points = load_method("oracle").reconstruct(inputs, SETTINGS, None, 3).points_mm
    np.testing.assert_allclose(np.abs(points).max(axis=1), 10.0, atol=1e-12)
    share = 20.0**2 / (20.0**2 + 19.6**2)  # of the area; 5000 draws: a standard deviation of 0.7 %
    assert abs(len(points) / 5000 - share) < 4.5 * 0.0071


def test_it_is_declared_as_a_bound():
    assert load_method("oracle").role is Role.BOUND
