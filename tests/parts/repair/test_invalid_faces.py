"""Faces without three corners, and faces that are there twice."""

import numpy as np
import pytest

from industnerf.parts.repair.invalid_faces import deduplicate_faces, unique_first
from tests.parts.repair.shapes import box, concatenated, flipped, select_faces, settings


@pytest.mark.parametrize("order", [slice(None), slice(None, None, -1)])
def test_repeated_faces_go_whichever_way_round(order):
    mesh = box()
    repeated = select_faces(mesh, slice(0, 3))
    doubled = concatenated(mesh, flipped(repeated) if order.step else repeated)
    doubled.faces[12:] -= 8  # on the same vertices
    [deduplicated], repairs, defects = deduplicate_faces([doubled], settings())
    np.testing.assert_array_equal(deduplicated.faces, mesh.faces)
    assert repairs == ["repeated faces dropped: 3"]
    assert defects == []


def test_faces_without_three_corners_go():
    mesh = box()
    mesh.faces[4, 1] = mesh.faces[4, 0]
    [deduplicated], repairs, _ = deduplicate_faces([mesh], settings())
    assert len(deduplicated.faces) == 11
    assert repairs == ["faces dropped that are welded to a line or a point: 1"]


def test_slivers_stay():
    """A needle carries no area, but dropping it would open the solid."""
    mesh = box()
    mesh.vertices[1] = mesh.vertices[0] + 1e-9
    assert deduplicate_faces([mesh], settings()) == ([mesh], [], [])


def test_the_first_of_several_stays():
    faces = np.array([[2, 1, 0], [3, 4, 5], [0, 1, 2], [1, 2, 0], [5, 4, 3]])
    assert unique_first(faces).tolist() == [True, True, False, False, False]
