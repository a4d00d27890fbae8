"""The checks on solids whose volume, area and defects are known."""

import numpy as np
import pytest

from industnerf.errors import BadPart
from industnerf.geometry.raycast import RaycastingScene
from industnerf.parts.validation import checks
from tests.solids import bow_tie, tube

SIDES = np.array([2.0, 3.0, 5.0])  # mm


def box(sides=SIDES, corner=(0.0, 0.0, 0.0)):
    """Vertices and outward faces of a box with its low corner at `corner`."""
    bits = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=np.float64)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return bits * sides + corner, np.array(faces, dtype=np.int32)


def ball(radius, rings, segments):
    """A polyhedron inscribed in the ball of `radius` mm about the origin."""
    polar = np.pi * np.arange(1, rings) / rings
    azimuth = 2 * np.pi * np.arange(segments) / segments
    p, a = np.meshgrid(polar, azimuth, indexing="ij")
    belt = np.stack([np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)], -1).reshape(-1, 3)
    vertices = radius * np.concatenate([belt, [[0, 0, 1], [0, 0, -1]]])
    top, bottom = len(belt), len(belt) + 1
    faces = []
    for j in range(segments):
        k = (j + 1) % segments
        last = (rings - 2) * segments
        faces += [(top, j, k), (bottom, last + k, last + j)]
        for i in range(rings - 2):
            a0, b0 = i * segments + j, i * segments + k
            faces += [(a0, a0 + segments, b0), (b0, a0 + segments, b0 + segments)]
    return vertices, np.array(faces, dtype=np.int32)


def back_share(vertices, faces):
    scene = RaycastingScene(vertices, faces)
    return checks.back_face_share(vertices, faces, lambda o, d: scene.cast(o, d).face)


@pytest.mark.parametrize("corner", [(0.0, 0.0, 0.0), (-1.0, 7.0, 2.0)])
def test_box(corner):
    vertices, faces = box(corner=corner)
    assert len(checks.bad_edges(faces)) == 0
    assert checks.volume_mm3(vertices, faces) == pytest.approx(2 * 3 * 5, rel=1e-14)
    assert checks.area_mm2(vertices, faces) == pytest.approx(2 * (6 + 10 + 15), rel=1e-14)
    assert checks.extents_mm(vertices) == pytest.approx(SIDES)
    assert checks.count_bodies(faces) == 1
    checks.require_watertight("box", vertices, faces)


def test_volume_survives_a_far_origin():
    vertices, faces = box(corner=(1e6 / 3, -1e6 / 7, 1e6 / 9))
    # A coordinate of 1e6 mm is rounded by 1e-10 mm at most, of a side of at least 2 mm.
    assert checks.volume_mm3(vertices, faces) == pytest.approx(30, rel=1e-9)


@pytest.mark.parametrize("rings", [16, 64])
def test_inscribed_ball_is_smaller_by_the_order_of_its_steps(rings):
    vertices, faces = ball(10.0, rings, 2 * rings)
    volume, area = 4 / 3 * np.pi * 10**3, 4 * np.pi * 10**2
    # Inscribed: always below.  A facet that spans the angle h lies at cos(h / 2) of the radius or
    # farther out, and both of its directions do: at least cos(h / 2)^2 of the radius.
    nearest = np.cos(np.pi / rings / 2) ** 2
    assert nearest**3 * volume < checks.volume_mm3(vertices, faces) < volume
    assert nearest**2 * area < checks.area_mm2(vertices, faces) < area


def test_two_boxes_are_two_bodies():
    a, faces = box()
    b, _ = box(corner=(10.0, 0.0, 0.0))
    assert checks.count_bodies(np.concatenate([faces, faces + len(a)])) == 2
    assert checks.volume_mm3(np.concatenate([a, b]), np.concatenate([faces, faces + 8])) == (
        pytest.approx(60)
    )


def test_pieces_of_two_boxes_are_found_in_any_order_of_faces():
    _, faces = box()
    both = np.concatenate([faces, faces + 20])  # numbers that no face uses do not count
    order = np.random.default_rng(0).permutation(24)
    piece = checks.surface_components(both[order])
    assert set(piece) == {0, 1}
    assert len({(number, face >= 12) for number, face in zip(piece, order, strict=True)}) == 2


def test_a_cavity_is_a_body_and_no_solid():
    outer, faces = box()
    inner, _ = box(sides=SIDES / 2, corner=SIDES / 4)
    apart, _ = box(corner=(10.0, 0.0, 0.0))
    hollow = np.concatenate([faces, faces[:, ::-1] + 8])
    assert checks.count_bodies(hollow) == 2
    assert checks.count_solids(np.concatenate([outer, inner]), hollow) == 1
    with_another = np.concatenate([hollow, faces + 16])
    assert checks.count_solids(np.concatenate([outer, inner, apart]), with_another) == 2


def test_solids_of_an_open_mesh_are_its_bodies():
    vertices, faces = box()
    lidless = np.concatenate([faces[:-1], faces + 8])
    assert checks.count_solids(np.concatenate([vertices, vertices + 10]), lidless) == 2


def test_through_holes_are_counted_of_closed_surfaces_only():
    ring = tube(5, 7, 20, sections=8).faces
    _, faces = box()
    assert checks.euler_number(ring) == 0
    assert checks.through_holes(ring) == 1
    assert checks.through_holes(np.concatenate([ring, faces + 100])) == 1
    assert checks.through_holes(faces) == 0
    assert checks.through_holes(ring[1:]) == 0


def test_a_missing_face_leaves_its_three_edges_open():
    vertices, faces = box()
    a, b, c = sorted(faces[-1].tolist())
    assert checks.bad_edges(faces[:-1]).tolist() == [[a, b], [a, c], [b, c]]
    with pytest.raises(BadPart, match=r"'lid' is not closed: 3 edges .* near \(.*\) mm"):
        checks.require_watertight("lid", vertices, faces[:-1])


def test_one_flipped_face_is_not_oriented():
    vertices, faces = box()
    faces[3] = faces[3, ::-1]
    assert len(checks.bad_edges(faces)) == 3
    with pytest.raises(BadPart, match="one orientation"):
        checks.require_watertight("flipped", vertices, faces)


def test_a_doubled_face_is_not_closed():
    _, faces = box()
    assert len(checks.bad_edges(np.concatenate([faces, faces[:1]]))) == 3


def test_inside_out_is_closed_but_not_sound():
    vertices, faces = box()
    inverted = np.ascontiguousarray(faces[:, ::-1])
    assert len(checks.bad_edges(inverted)) == 0
    assert checks.volume_mm3(vertices, inverted) == pytest.approx(-30)
    with pytest.raises(BadPart, match="inside out"):
        checks.require_watertight("inverted", vertices, inverted)


def test_a_sound_solid_shows_no_back_face_and_an_inverted_one_nothing_else():
    vertices, faces = ball(10.0, 16, 32)
    assert back_share(vertices, faces) == 0
    assert back_share(vertices, np.ascontiguousarray(faces[:, ::-1])) == 1


def test_a_solid_that_crosses_itself_shows_its_inside():
    mesh = bow_tie()
    vertices, faces = mesh.vertices, mesh.faces
    checks.require_watertight("bow tie", vertices, faces)
    assert checks.volume_mm3(vertices, faces) == pytest.approx(12 - 3)
    assert back_share(vertices, faces) > 0.1
