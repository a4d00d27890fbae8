"""Faces that others pass through, of bodies whose crossing is known."""

import numpy as np
import pytest
import trimesh

from industnerf.geometry.crossing_faces import crossing_faces
from industnerf.geometry.embree_tree import EmbreeTree


def crossing_in(solid: trimesh.Trimesh) -> np.ndarray:
    vertices = np.array(solid.vertices, np.float32)
    faces = np.array(solid.faces, np.int32)
    tree = EmbreeTree(vertices, faces)
    return crossing_faces(tree, vertices[faces])


@pytest.mark.parametrize("merged", [True, False])
@pytest.mark.parametrize(
    "solid",
    [
        trimesh.creation.box((2, 3, 4)),
        trimesh.creation.icosphere(3),
        trimesh.creation.annulus(0.5, 1, 0.4, sections=64),
    ],
    ids=["box", "ball", "ring"],
)
def test_neighbors_do_not_cross(solid, merged):
    """Nor do faces whose corners are the same points twice over."""
    solid = solid.copy()
    if not merged:
        solid.unmerge_vertices()
    assert not crossing_in(solid).any()


def test_a_rod_through_a_block_crosses_top_and_bottom():
    """Rod and block are boxes: of each the faces that stand across the other's are pierced."""
    block = trimesh.creation.box((4, 4, 1))
    rod = trimesh.creation.box((1.1, 1.3, 6))
    solid = trimesh.util.concatenate([block, rod])
    normal_axis = np.abs(solid.face_normals).argmax(axis=1)
    is_rod = np.arange(len(solid.faces)) >= len(block.faces)
    expected = np.where(is_rod, normal_axis != 2, normal_axis == 2)
    np.testing.assert_array_equal(crossing_in(solid), expected)


def test_bodies_that_stand_apart_do_not_cross():
    far_box = trimesh.creation.box((1, 1, 1))
    far_box.apply_translation([3, 0, 0])
    assert not crossing_in(trimesh.util.concatenate([trimesh.creation.icosphere(2), far_box])).any()
