"""Faces without three corners, and faces that are there twice."""

import numpy as np
import pytest

from industnerf.parts.cleaning.distinct import distinct, first_ones
from tests.parts.cleaning.shapes import box, picked, settings, together, turned


@pytest.mark.parametrize("way", [slice(None), slice(None, None, -1)])
def test_repeated_faces_go_whichever_way_round(way):
    mesh = box()
    again = picked(mesh, slice(0, 3))
    doubled = together(mesh, turned(again) if way.step else again)
    doubled.faces[12:] -= 8  # on the same vertices
    [kept], told, left = distinct([doubled], settings())
    np.testing.assert_array_equal(kept.faces, mesh.faces)
    assert told == ["repeated faces dropped: 3"]
    assert left == []


def test_faces_without_three_corners_go():
    mesh = box()
    mesh.faces[4, 1] = mesh.faces[4, 0]
    [kept], told, _ = distinct([mesh], settings())
    assert len(kept.faces) == 11
    assert told == ["faces dropped that are welded to a line or a point: 1"]


def test_slivers_stay():
    """A needle carries no area, but dropping it would open the solid."""
    mesh = box()
    mesh.vertices[1] = mesh.vertices[0] + 1e-9
    assert distinct([mesh], settings()) == ([mesh], [], [])


def test_the_first_of_several_stays():
    faces = np.array([[2, 1, 0], [3, 4, 5], [0, 1, 2], [1, 2, 0], [5, 4, 3]])
    assert first_ones(faces).tolist() == [True, True, False, False, False]
