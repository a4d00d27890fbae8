"""The oracle is the truth, sampled anew."""

import numpy as np
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.methods import load_method
from industnerf.methods.base import Input, MethodInputs, Role
from industnerf.schema import SampleSettings
from tests.methods.solids import cameras_around


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


def test_it_is_declared_as_a_bound():
    assert load_method("oracle").role is Role.BOUND
