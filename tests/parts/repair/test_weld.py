"""Vertices that should be one."""

import numpy as np
import pytest

from industnerf.errors import BadPart
from industnerf.parts.repair.weld import coincident_groups, weld
from tests.parts.repair.shapes import (
    ball,
    box,
    concatenated,
    scaled,
    select_faces,
    settings,
    triangle_soup,
)


def to_unit_diagonal(mesh):
    """About the frame in which cleaning works."""
    return scaled(mesh, 1 / np.linalg.norm(np.ptp(mesh.vertices, axis=0)))


def test_a_soup_becomes_the_box_that_it_was():
    [mesh], repairs, defects = weld([triangle_soup(to_unit_diagonal(box()))], settings())
    assert len(mesh.vertices) == 8
    assert repairs == defects == []  # corners at exactly the same place are no defect
    np.testing.assert_array_equal(mesh.triangles, to_unit_diagonal(box()).triangles)


@pytest.mark.parametrize(("gap", "vertices", "expected"), [(1e-7, 8, ["6"]), (1e-5, 14, [])])
def test_a_crack_is_closed_if_it_is_narrower_than_the_tolerance(gap, vertices, expected):
    mesh = to_unit_diagonal(
        box()
    )  # six of its faces touch seven of its corners, and the other six do
    halves = concatenated(select_faces(mesh, slice(0, 6)), select_faces(mesh, slice(6, 12)))
    halves.vertices[8:] += gap / 2
    [welded], repairs, _ = weld([halves], settings(weld=1e-6))
    assert len(welded.vertices) == vertices
    assert [text.split(": ")[1] for text in repairs] == expected


def test_solids_that_touch_stay_apart():
    left, right = box((1.0, 1.0, 1.0)), box((1.0, 1.0, 1.0), (1.0, 0.0, 0.0))
    welded, _, _ = weld([triangle_soup(left), triangle_soup(right)], settings())
    assert [len(mesh.vertices) for mesh in welded] == [8, 8]


def test_a_closed_solid_keeps_vertices_nearer_than_the_tolerance():
    """The crests of a thread can touch; to weld them would open the solid."""
    mesh = ball(0.5)
    top = int(mesh.vertices[:, 2].argmax())
    other = int(mesh.vertices[:, 0].argmax())
    mesh.vertices[other] = mesh.vertices[top] + 1e-9
    [welded], repairs, _ = weld([mesh], settings(weld=1e-6))
    assert welded is mesh
    assert repairs == []


def test_a_part_that_is_a_point_beside_one_far_vertex_is_refused():
    mesh = triangle_soup(ball(1e-9, subdivisions=3))
    mesh.vertices[0] = 1.0
    with pytest.raises(BadPart, match=r"one vertex lies so far off .* parts\.repair\.weld"):
        weld([mesh], settings(weld=1e-6))


def test_coincident_points_share_a_number():
    rng = np.random.default_rng(0)
    points = rng.integers(0, 3, (200, 3)).astype(float)
    _, expected = np.unique(points, axis=0, return_inverse=True)
    number = coincident_groups(points)
    same = number[:, None] == number[None]
    np.testing.assert_array_equal(same, expected.ravel()[:, None] == expected.ravel()[None])
    assert number.max() + 1 == len(np.unique(number))
