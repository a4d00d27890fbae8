"""The cube round a part."""

import numpy as np

from industnerf.geometry.bounding_cube import BoundingCube

CORNERS = np.array([[10.0, 0.0, -4.0], [30.0, 8.0, 0.0], [12.0, 3.0, -1.0]])


def test_the_longest_edge_fills_the_unit_cube_and_the_center_is_its_own():
    cube = BoundingCube.of(CORNERS)
    np.testing.assert_allclose(cube.center_mm, [20, 4, -2])
    assert cube.edge_mm == 20
    np.testing.assert_allclose(cube.to_unit(CORNERS)[:2], [[-0.5, -0.2, -0.1], [0.5, 0.2, 0.1]])


def test_there_and_back():
    cube = BoundingCube.of(CORNERS)
    np.testing.assert_allclose(cube.to_mm(cube.to_unit(CORNERS)), CORNERS)
