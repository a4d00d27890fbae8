"""Bodies that overlap, found and united."""

import numpy as np
import pytest

from industnerf.parts.repair import union
from industnerf.parts.repair.union import boolean_union, closed_bodies, find_overlaps
from industnerf.parts.validation.checks import area_mm2, bad_edges, count_bodies
from tests.parts.repair.shapes import (
    ball,
    box,
    concatenated,
    flipped,
    select_faces,
    settings,
    volume,
)

UNION = settings(boolean_union=True)
PLATE, BAR = box((4, 4, 1), finish=1), box((1, 1, 4), (0.1, 0.2, 0.3), finish=2)  # share 1 mm^3


@pytest.mark.parametrize("solids", [[PLATE, BAR], [concatenated(PLATE, BAR)]])
def test_two_boxes_that_cross_are_found_and_left(solids):
    unchanged, repairs, defects = boolean_union(solids, settings())
    assert unchanged is solids
    assert repairs == []
    assert defects == [
        "overlapping pairs of bodies: 1, by up to 25.0% of the smaller (parts.repair.boolean_union "
        "unites them)"
    ]


@pytest.mark.parametrize("solids", [[PLATE, BAR], [concatenated(PLATE, BAR)]])
def test_two_boxes_that_cross_become_one_that_keeps_both_finishes(solids):
    [mesh], repairs, defects = boolean_union(solids, UNION)
    assert repairs == ["overlapping bodies united: 2 to 1"]
    assert defects == []
    assert count_bodies(mesh.faces) == 1
    assert len(bad_edges(mesh.faces)) == 0
    assert volume(mesh) == pytest.approx(16 + 4 - 1, rel=1e-12)
    for finish, area in ((1, 32 + 16 - 2), (2, 2 + 16 - 4)):  # each less what the other covers
        own_faces = select_faces(mesh, mesh.finish == finish)
        assert area_mm2(own_faces.vertices, own_faces.faces) == pytest.approx(area, rel=1e-12)


def test_bodies_that_touch_or_stand_apart_do_not_overlap():
    solids = [box((1, 1, 1)), box((1, 1, 1), (1, 0, 0)), ball(1.0, (9, 0, 0))]
    assert boolean_union(solids, UNION) == (solids, [], [])


def test_a_cavity_belongs_to_its_body_and_holds_another():
    """A ball within the cavity of a box overlaps nothing; in the full box it would."""
    hollow = concatenated(box((8, 8, 8)), flipped(box((6, 6, 6))))
    closed = closed_bodies([hollow, ball(2.0)])
    assert [body.manifold.volume() for body in closed] == pytest.approx(
        [512 - 216, volume(ball(2.0))]
    )
    assert len(find_overlaps(closed).pairs) == 0
    assert len(find_overlaps(closed_bodies([box((8, 8, 8)), ball(2.0)])).pairs) == 1


def test_what_is_open_or_inside_out_is_no_body():
    assert closed_bodies([select_faces(box(), slice(1, None)), flipped(ball())]) == []


def test_a_united_body_leaves_the_others_as_they_were():
    apart = ball(1.0, (9, 0, 0), finish=7)
    repaired, _, _ = boolean_union(
        [apart, concatenated(PLATE, BAR, select_faces(box(), [0]))], UNION
    )
    assert [len(mesh.faces) for mesh in repaired[:2]] == [320, 1]
    np.testing.assert_array_equal(repaired[0].triangles, apart.triangles)
    assert volume(repaired[2]) == pytest.approx(19)


@pytest.mark.parametrize("clean_settings", [settings(), UNION])
def test_more_pairs_than_can_be_looked_at_are_counted(monkeypatch, clean_settings):
    monkeypatch.setattr(union, "MAX_PAIRS", 2)
    _, _, defects = boolean_union([box(), box(), box((1, 1, 1))], clean_settings)
    assert defects[-1] == "pairs of bodies not searched for overlap: 1, beyond the first 2"
