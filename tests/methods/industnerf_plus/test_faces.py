"""Faces of a turned block: where they are, and at right angles."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from industnerf.methods.industnerf_plus.distance_grid import DistanceGrid, redistance
from industnerf.methods.industnerf_plus.faces import Face, find_faces, square_up, with_products
from industnerf.methods.industnerf_plus.shaded_surface import ShadedSurface

from .plugged_block import CELL, CENTERED, LO, SIZE

HALF = np.array([17.3, 15.3, 11.3])
TURN = Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix()


def turned_block(noise: float) -> ShadedSurface:
    beyond = np.abs(CENTERED @ TURN) - HALF
    distance = np.linalg.norm(np.maximum(beyond, 0), axis=-1) + np.minimum(beyond.max(-1), 0)
    distance += noise * np.random.default_rng(0).standard_normal(distance.shape)
    exact = redistance(distance.astype(np.float32))
    surface = ShadedSurface(DistanceGrid(exact, exact - 5, LO, CELL))
    surface.update_band(0.3)
    return surface


@pytest.mark.parametrize("noise", [0.0, 0.15])
def test_all_six_faces_are_found_and_squared_up(noise):
    """A fit to a thousand nodes that are 0.2 cells off has 0.2 / sqrt(1000) of that left."""
    faces = find_faces(turned_block(noise), most=20)
    assert len(faces) >= 6
    for axis in range(3):
        for sign in (-1, 1):
            along = [sign * face.normal @ TURN[:, axis] for face in faces[:6]]
            face = faces[int(np.argmax(along))]
            assert max(along) > np.cos(np.radians(0.3))
            offset = face.offset - face.normal @ np.full(3, (SIZE - 1) / 2)
            assert abs(offset - HALF[axis]) < 0.15
    gram = np.array([face.normal for face in faces[:6]])
    products = np.abs(gram @ gram.T)
    assert (np.minimum(products, np.abs(products - 1)) < 1e-6).all()


def test_a_slanted_face_stays_slanted():
    x, y = np.eye(3)[:2]
    slanted = np.array([0, np.sin(0.2), np.cos(0.2)])
    faces = [Face(x, 1.0, 900), Face(y, 2.0, 800), Face(slanted, 3.0, 700)]
    squared = square_up(faces, np.zeros((0, 3)))
    np.testing.assert_allclose(squared[2].normal, slanted)
    assert squared[2].offset == 3.0


def test_faces_without_a_right_angle_stay_as_they_are():
    faces = [Face(np.array([1.0, 0, 0]), 1.0, 90), Face(np.array([0.8, 0.6, 0]), 2.0, 80)]
    assert square_up(faces, np.zeros((0, 3))) == faces


def test_two_normals_give_the_ends_of_their_profile():
    normals = with_products(np.array([[1.0, 0, 0], [0, 1.0, 0]]))
    found = {tuple(np.rint(normal).astype(int)) for normal in normals}
    assert found == {(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)}
