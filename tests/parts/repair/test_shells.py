"""Shells, their windings and volumes; and which holds which."""

import numpy as np
import pytest

from industnerf.parts.repair.shells import ContainmentTree, find_shells, winding_number
from tests.parts.repair.shapes import ball, box, concatenated, flipped, select_faces, tube, volume


def moebius(n=12):
    """A strip of `n` quads with half a twist: two triangles each."""
    along = 2 * np.pi * np.arange(n) / n
    ring = np.stack([np.cos(along), np.sin(along), 0 * along], 1)
    across = np.cos(along / 2)[:, None] * ring + np.sin(along / 2)[:, None] * [0, 0, 1]
    vertices = np.concatenate([ring + 0.3 * across, ring - 0.3 * across])
    faces = []
    for i in range(n):
        j, up, down = (i + 1) % n, i, i + n
        next_up, next_down = (j, j + n) if j else (n, 0)  # the twist
        faces += [(up, down, next_up), (down, next_down, next_up)]
    mesh = box()
    return type(mesh)(vertices, np.array(faces, np.int32), np.zeros(len(faces), np.uint8))


def test_a_box_and_a_ball():
    shells = find_shells(concatenated(box((3, 2, 1)), ball(1.0, (9, 0, 0))))
    assert len(shells) == 2
    assert shells.is_closed.all()
    assert not shells.is_minority.any()
    assert shells.volume == pytest.approx([6, volume(ball(1.0))], rel=1e-12)


@pytest.mark.parametrize("mesh", [box(), ball(), tube()])
@pytest.mark.parametrize("share", [0.1, 0.4])
def test_turning_the_odd_faces_makes_the_windings_agree(mesh, share):
    rng = np.random.default_rng(3)
    # Fewer than half of the area, so that the odd ones are those that were turned.
    some = rng.permutation(len(mesh.faces))[: int(share * len(mesh.faces))]
    shells = find_shells(flipped(mesh, some))
    fixed = flipped(flipped(mesh, some), shells.is_minority)
    assert shells.is_closed.all()
    assert abs(volume(fixed)) == pytest.approx(volume(mesh), rel=1e-12)
    assert shells.volume[0] == pytest.approx(volume(fixed), rel=1e-12)
    if share < 0.2:  # a tenth of the faces of any of these is less than half of the area
        np.testing.assert_array_equal(np.flatnonzero(shells.is_minority), np.sort(some))


def test_the_odd_faces_are_those_of_less_area():
    mesh = box((3, 2, 1))
    for some in ([0], [0, 1], [5], list(range(1, 12))):
        few = some if len(some) < 6 else [0]
        assert np.flatnonzero(find_shells(flipped(mesh, some)).is_minority).tolist() == few


def test_an_open_shell_is_not_closed():
    shells = find_shells(select_faces(box(), slice(0, 11)))
    assert shells.is_two_sided.all()
    assert not shells.is_closed.any()


def test_a_moebius_strip_has_one_side():
    shells = find_shells(moebius())
    assert len(shells) == 1
    assert not shells.is_two_sided.any()
    assert not shells.is_minority.any()


def test_two_boxes_that_share_an_edge_are_two_closed_shells():
    mesh = concatenated(box((1, 1, 1)), box((1, 1, 1), (1, 1, 0)))
    positions, inverse = np.unique(mesh.vertices, axis=0, return_inverse=True)
    assert len(positions) == 14
    shells = find_shells(
        type(mesh)(positions, inverse.ravel()[mesh.faces].astype(np.int32), mesh.finish)
    )
    assert shells.is_closed.tolist() == [True, True]
    assert shells.volume == pytest.approx([1, 1])


def test_the_winding_number_counts_the_layers_around_a_point():
    layers = concatenated(box((4, 4, 4)), box((2, 2, 2)))
    for point, times in (([0, 0, 0], 2), ([1.5, 0, 0], 1), ([3, 0, 0], 0)):
        # The solid angle of a plane face is exact but for rounding of its few terms.
        winding = winding_number(layers.triangles, np.array(point, float))
        assert winding == pytest.approx(times, abs=1e-12)
    inverted = flipped(box((4, 4, 4)))
    assert winding_number(inverted.triangles, np.zeros(3)) == pytest.approx(-1, abs=1e-12)


def test_a_nest_knows_what_lies_in_what():
    mesh = concatenated(box((8, 8, 8)), ball(2.0), box((1, 1, 1), (7, 0, 0)), tube(3.0, 3.9, 6.0))
    containment = ContainmentTree(mesh, find_shells(mesh))
    shells = np.arange(4)
    assert containment.containing_shells(1, shells) == [
        0
    ]  # within the tube's bore, not in its wall
    assert containment.containing_shells(2, shells) == []
    assert containment.containing_shells(3, shells) == [0]
    assert containment.containing_shells(0, shells) == []
