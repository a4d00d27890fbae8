"""Faces turned outward."""

import numpy as np
import pytest

from industnerf.artifacts.part import Mesh
from industnerf.geometry.raycast import RaycastingScene
from industnerf.parts.repair.orient import MIN_GAIN, fix_winding, ray_votes
from industnerf.parts.validation.checks import back_face_share, bad_edges
from tests.parts.repair.shapes import (
    ball,
    box,
    concatenated,
    flipped,
    scaled,
    select_faces,
    settings,
    triangle_soup,
    tube,
    volume,
)
from tests.solids import bow_tie


def test_a_sound_solid_is_left_alone():
    solids = [box(), ball(3.0, (50, 0, 0))]
    assert fix_winding(solids, settings()) == (solids, [], [])


def test_an_inside_out_solid_is_turned():
    [mesh], repairs, _ = fix_winding([flipped(ball())], settings())
    assert volume(mesh) == pytest.approx(volume(ball()))
    assert repairs == [
        "faces turned: 320 of 320; of the rays from outside, 100.00% met a face from behind, "
        "now 0.00%"
    ]


@pytest.mark.parametrize("share", [0.05, 0.3, 0.5, 0.8])
def test_any_mixture_of_windings_comes_out_outward(share):
    rng = np.random.default_rng(int(100 * share))
    mesh = concatenated(ball(), tube(11.0, 14.0, 5.0))
    mixed = flipped(mesh, rng.random(len(mesh.faces)) < share)
    [fixed], _, _ = fix_winding([mixed], settings())
    np.testing.assert_array_equal(np.sort(fixed.faces), np.sort(mesh.faces))
    assert len(bad_edges(fixed.faces)) == 0
    assert volume(fixed) == pytest.approx(volume(mesh), rel=1e-12)


def hollow():
    return concatenated(box((4, 4, 4)), flipped(box((2, 2, 2))))


def test_a_cavity_is_rightly_inside_out():
    [mesh], repairs, _ = fix_winding([hollow()], settings())
    assert volume(mesh) == pytest.approx(64 - 8)
    assert repairs == []


def test_a_hollow_solid_that_is_inside_out_is_turned_with_its_cavity():
    [mesh], repairs, _ = fix_winding([flipped(hollow())], settings())
    assert volume(mesh) == pytest.approx(64 - 8)
    assert repairs[0].startswith("faces turned: 24 of 24")


def test_a_cavity_that_a_few_rays_reach_through_a_crack_stays_a_cavity():
    outer = ball(4.0, subdivisions=5)
    cracked = concatenated(select_faces(outer, slice(1, None)), flipped(box((2, 2, 2))))
    assert ray_votes(cracked).back[-12:].sum() > 0
    [mesh], repairs, _ = fix_winding([cracked], settings())
    np.testing.assert_array_equal(mesh.faces, cracked.faces)
    assert repairs == []


def test_a_ball_that_stands_alone_meets_the_rays_that_cauchy_promises():
    votes = ray_votes(concatenated(ball(1.0, subdivisions=4), ball(0.5, (3, 0, 0), subdivisions=4)))
    for faces, radius in ((slice(0, 5120), 1.0), (slice(5120, None), 0.5)):
        # Views in which one hides the other are few: the angle under which they meet is small.
        expected = votes.density * 4 * np.pi * radius**2
        assert votes.front[faces].sum() == pytest.approx(expected, rel=0.05)


def test_a_hidden_solid_of_another_solid_is_oriented_by_its_volume():
    [_, inner], repairs, _ = fix_winding([box((4, 4, 4)), flipped(box((2, 2, 2)))], settings())
    assert volume(inner) == pytest.approx(8)
    assert repairs == ["faces turned: 12 of 24, which hardly a ray from outside meets"]


def test_a_sheet_seen_from_both_sides_stays_as_it_is():
    plate = box((4, 4, 1))
    sheet = select_faces(plate, np.flatnonzero((plate.triangles[..., 2] > 0).all(axis=1)))
    assert len(sheet.faces) == 2
    for solids in ([sheet], [flipped(sheet)]):
        assert fix_winding(solids, settings()) == (solids, [], [])


def test_a_box_without_a_lid_shows_its_inside_and_is_not_turned():
    lidless = select_faces(box((4, 4, 4)), slice(0, 10))
    [mesh], repairs, _ = fix_winding([lidless], settings())
    np.testing.assert_array_equal(mesh.faces, lidless.faces)
    assert repairs == []
    [mesh], repairs, _ = fix_winding([flipped(lidless, [3])], settings())
    np.testing.assert_array_equal(mesh.faces, lidless.faces)
    assert len(repairs) == 1


def ball_with_a_window_on(fragment):
    """A hollow ball, open at the top, and below its floor's inside a `fragment` that faces out."""
    wall = ball(1.0, subdivisions=4)
    open_top = wall.triangles[..., 2].min(axis=1) < 0.9
    return concatenated(select_faces(wall, open_top), scaled(fragment, 1.0, (0, 0, -0.9)))


def test_a_turn_that_improves_nothing_is_undone():
    """A few rays meet the fragment from behind, through the window; its front none."""
    corners = np.array([[0.0, 0, 0], [0, 0.1, 0], [0.1, 0, 0]])  # wound to face down, and out
    mesh = ball_with_a_window_on(Mesh.with_one_appearance(corners, np.array([[0, 1, 2]], np.int32)))
    votes = ray_votes(mesh)
    assert 0 < votes.back[-1] < MIN_GAIN * (votes.front + votes.back).sum()
    assert votes.front[-1] == 0
    assert fix_winding([mesh], settings()) == ([mesh], [], [])


def test_of_a_soup_all_triangles_count_together():
    """Each one alone would improve too little."""
    soup = flipped(triangle_soup(ball(1.0, subdivisions=5)))
    votes = ray_votes(soup)
    assert votes.back.max() < MIN_GAIN * (votes.front + votes.back).sum()
    [mesh], _, _ = fix_winding([soup], settings())
    np.testing.assert_array_equal(mesh.faces, soup.faces[:, ::-1])


def test_a_sliver_that_no_ray_meets_is_wound_as_its_neighbors():
    lidless = select_faces(box((4, 4, 4)), slice(0, 10))
    a, b = lidless.faces[0, :2]
    far = len(lidless.vertices)
    middle = lidless.vertices[[a, b]].mean(axis=0) * (1 + 1e-9)
    faces = lidless.faces.copy()
    c = faces[0, 2]
    split = np.array([[a, far, c], [far, b, c], [a, far, b]], np.int32)  # the last: wrongly wound
    mesh = Mesh.with_one_appearance(
        np.concatenate([lidless.vertices, middle[None]]), np.concatenate([split, faces[1:]])
    )
    [fixed], repairs, _ = fix_winding([mesh], settings())
    np.testing.assert_array_equal(fixed.faces[2], mesh.faces[2, ::-1])
    assert repairs == ["faces turned: 1 of 12, which hardly a ray from outside meets"]


def test_a_solid_that_crosses_itself_keeps_windings_that_hide_its_inside():
    tie = bow_tie()
    outward = flipped(tie, (tie.triangles[..., 0] <= 0).all(axis=1))
    assert ray_votes(outward).back.sum() == 0
    assert ray_votes(tie).back.sum() > 0
    solids = [outward]
    assert fix_winding(solids, settings()) == (solids, [], [])


@pytest.mark.parametrize("seed", range(5))
def test_no_mesh_comes_out_worse_than_it_went_in(seed):
    """On the rays that vote that is exact, whatever the mesh is."""
    rng = np.random.default_rng(seed)
    torn = select_faces(ball(1.0), rng.permutation(320)[:200])
    mesh = concatenated(scaled(bow_tie(), 0.3, rng.random(3)), torn)
    mesh = flipped(mesh, rng.random(len(mesh.faces)) < rng.random())
    [after], _, _ = fix_winding([mesh], settings())
    votes, before = ray_votes(after), ray_votes(mesh)
    assert votes.back.sum() <= before.back.sum()
    np.testing.assert_array_equal(votes.front + votes.back, before.front + before.back)


def test_votes_find_the_share_that_the_check_finds():
    """Other rays at the same surface: two estimates of one share."""
    mesh = flipped(ball(), slice(0, 80))
    scene = RaycastingScene(mesh.vertices, mesh.faces)
    share = back_face_share(mesh.vertices, mesh.faces, lambda o, d: scene.cast(o, d).face)
    votes = ray_votes(mesh)
    # A quarter of 180 000 rays: a standard error of 0.1 % were they independent.
    assert votes.back_share(np.zeros(320, bool)) == pytest.approx(share, abs=5e-3)
    assert votes.back_share(np.ones(320, bool)) == pytest.approx(1 - share, abs=5e-3)


def test_the_finish_of_a_turned_face_stays_with_it():
    mesh = flipped(ball(), slice(0, 80))
    mesh.finish[:80] = 3
    [fixed], _, _ = fix_winding([mesh], settings())
    np.testing.assert_array_equal(fixed.finish, mesh.finish)
    np.testing.assert_array_equal(np.sort(fixed.faces), np.sort(mesh.faces))


def test_it_can_be_left_out():
    solids = [flipped(box())]
    assert fix_winding(solids, settings(fix_winding=False)) == (solids, [], [])


def test_a_cavity_of_mixed_windings_becomes_a_cavity():
    [mesh], _, _ = fix_winding([flipped(hollow(), [0, 1, 2, 12, 13, 20])], settings())
    assert volume(mesh) == pytest.approx(64 - 8)
