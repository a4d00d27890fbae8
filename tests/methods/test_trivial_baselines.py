"""The nulls know the part's box and nothing else."""

import numpy as np
import pytest

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
