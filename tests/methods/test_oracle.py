"""The oracle is the truth, sampled anew."""

import numpy as np
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.methods import load_method
from industnerf.methods.base import Given, Input, Role
from industnerf.schema import SampleSettings
from tests.methods.solids import cameras_around


def test_points_lie_on_the_part_and_all_over_it():
    ball = trimesh.creation.icosphere(4, 20.0)
    mesh = Mesh(np.array(ball.vertices, float), ball.faces.astype(np.int32))
    given = Given("oracle", cameras_around(2, 8, 50.0), {Input.OWN_MESH: mesh})
    points = load_method("oracle").reconstruct(given, SampleSettings(20_000), None, 3).points_mm
    radius = np.linalg.norm(points, axis=1)
    # The mesh is inscribed: a face dips as far as its plane, and no face farther than that.
    dip = np.einsum("ij,ij->i", ball.face_normals, ball.triangles[:, 0]).min()
    assert dip - 1e-9 < radius.min() <= radius.max() < 20 + 1e-9
    octant = (points > 0) @ [4, 2, 1]
    z = (np.bincount(octant, minlength=8) - 2500) / np.sqrt(2500 * 7 / 8)
    assert np.abs(z).max() < 4  # by chance once in 2000 seeds


def test_it_is_declared_as_a_bound():
    assert load_method("oracle").role is Role.BOUND
