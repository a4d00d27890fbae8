"""In how many pieces a mesh is, where pieces may be hollow and lie in each other."""

import numpy as np
import pytest
import trimesh

from industnerf.reconstruct.mesh_pieces import (
    keep_largest,
    pieces_sentence,
    split_pieces,
    winding_number,
)


def ball(radius, center=(0.0, 0, 0), hollow=False):
    mesh = trimesh.creation.icosphere(2, radius)
    mesh.apply_translation(center)
    mesh.visual.vertex_colors = np.tile([10, 20, 30, 255], (len(mesh.vertices), 1)).astype(np.uint8)
    if hollow:
        mesh.invert()
    return mesh


LARGE, CAVITY, INNER = ball(10), ball(6, hollow=True), ball(2)
SPECK = ball(1, (20.0, 0, 0))
MESH = trimesh.util.concatenate([SPECK, CAVITY, INNER, LARGE])


def test_a_cavity_belongs_to_the_solid_about_it_and_what_is_in_it_does_not():
    pieces = split_pieces(MESH)
    expected = [LARGE.volume + CAVITY.volume, INNER.volume, SPECK.volume]
    assert [piece.volume for piece in pieces] == pytest.approx(expected, rel=1e-9)
    assert len(pieces[0].faces) == len(LARGE.faces) + len(CAVITY.faces)


def test_the_largest_are_kept_closed_and_in_color():
    pieces = split_pieces(MESH)
    kept = keep_largest(MESH, pieces, 1)
    assert kept.is_watertight
    assert kept.volume == pytest.approx(LARGE.volume + CAVITY.volume, rel=1e-9)
    assert (kept.visual.vertex_colors[:, :3] == [10, 20, 30]).all()
    assert keep_largest(MESH, pieces, 9).volume == pytest.approx(MESH.volume, rel=1e-9)


def test_the_sentence_says_how_many():
    pieces = split_pieces(MESH)
    assert pieces_sentence(split_pieces(SPECK), None) == "in 1 piece"
    text = pieces_sentence(pieces, None)
    assert text.startswith("in 3 pieces, of which the largest has 98.9% of the volume")
    assert "--mesh-pieces" in text
    assert pieces_sentence(pieces, 2).endswith("; the 2 largest are kept")


def test_a_closed_surface_winds_once_about_what_it_holds():
    for point, times in (([0, 0, 0], 1), ([9.9, 0, 0], 0), ([0, 8, 0], 1), ([11, 0, 0], 0)):
        # the sphere of triangles ends at 9.8 between its vertices
        assert winding_number(LARGE.triangles, np.array(point, float)) == pytest.approx(
            times, abs=1e-9
        ) or point == [9.9, 0, 0]
