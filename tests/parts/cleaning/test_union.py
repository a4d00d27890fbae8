"""Bodies that overlap, found and united."""

import numpy as np
import pytest

from industnerf.parts.checks import area_mm2, bad_edges, bodies
from industnerf.parts.cleaning import overlaps
from industnerf.parts.cleaning.bodies import bodies_of
from industnerf.parts.cleaning.overlaps import overlaps_of
from industnerf.parts.cleaning.union import unite
from tests.parts.cleaning.shapes import ball, box, picked, settings, together, turned, volume

UNION = settings(union=True)
PLATE, BAR = box((4, 4, 1), finish=1), box((1, 1, 4), (0.1, 0.2, 0.3), finish=2)  # share 1 mm^3


@pytest.mark.parametrize("solids", [[PLATE, BAR], [together(PLATE, BAR)]])
def test_two_boxes_that_cross_are_found_and_left(solids):
    left, told, remains = unite(solids, settings())
    assert left is solids
    assert told == []
    assert remains == [
        "overlapping pairs of bodies: 1, by up to 25.0% of the smaller (parts.clean.union unites "
        "them)"
    ]


@pytest.mark.parametrize("solids", [[PLATE, BAR], [together(PLATE, BAR)]])
def test_two_boxes_that_cross_become_one_that_keeps_both_finishes(solids):
    [mesh], told, remains = unite(solids, UNION)
    assert told == ["overlapping bodies united: 2 to 1"]
    assert remains == []
    assert bodies(mesh.faces) == 1
    assert len(bad_edges(mesh.faces)) == 0
    assert volume(mesh) == pytest.approx(16 + 4 - 1, rel=1e-12)
    for finish, area in ((1, 32 + 16 - 2), (2, 2 + 16 - 4)):  # each less what the other covers
        own = picked(mesh, mesh.finish == finish)
        assert area_mm2(own.vertices, own.faces) == pytest.approx(area, rel=1e-12)


def test_bodies_that_touch_or_stand_apart_do_not_overlap():
    solids = [box((1, 1, 1)), box((1, 1, 1), (1, 0, 0)), ball(1.0, (9, 0, 0))]
    assert unite(solids, UNION) == (solids, [], [])


def test_a_cavity_belongs_to_its_body_and_holds_another():
    """A ball within the cavity of a box overlaps nothing; in the full box it would."""
    hollow = together(box((8, 8, 8)), turned(box((6, 6, 6))))
    found = bodies_of([hollow, ball(2.0)])
    assert [body.manifold.volume() for body in found] == pytest.approx(
        [512 - 216, volume(ball(2.0))]
    )
    assert len(overlaps_of(found).pairs) == 0
    assert len(overlaps_of(bodies_of([box((8, 8, 8)), ball(2.0)])).pairs) == 1


def test_what_is_open_or_inside_out_is_no_body():
    assert bodies_of([picked(box(), slice(1, None)), turned(ball())]) == []


def test_a_united_body_leaves_the_others_as_they_were():
    apart = ball(1.0, (9, 0, 0), finish=7)
    left, _, _ = unite([apart, together(PLATE, BAR, picked(box(), [0]))], UNION)
    assert [len(mesh.faces) for mesh in left[:2]] == [320, 1]
    np.testing.assert_array_equal(left[0].triangles, apart.triangles)
    assert volume(left[2]) == pytest.approx(19)


@pytest.mark.parametrize("asked", [settings(), UNION])
def test_more_pairs_than_can_be_looked_at_are_counted(monkeypatch, asked):
    monkeypatch.setattr(overlaps, "MOST_PAIRS", 2)
    _, _, remains = unite([box(), box(), box((1, 1, 1))], asked)
    assert remains[-1] == "pairs of bodies not searched for overlap: 1, beyond the first 2"
