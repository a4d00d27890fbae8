"""Small flat holes, closed only if asked."""

import numpy as np
import pytest

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.edges import build_edges
from industnerf.parts.repair.holes import border_loops, fill_holes
from industnerf.parts.validation.checks import bad_edges, double_area_normals
from tests.parts.repair.shapes import ball, box, select_faces, settings, volume

FILL = settings(fill_holes=True)
BALL = ball(0.5 / np.sqrt(3), subdivisions=4)  # its box has a diagonal of 1


def without_fan(mesh, vertex):
    """`mesh` without the faces around one vertex: a hole with a border of five or six."""
    return select_faces(mesh, ~(mesh.faces == vertex).any(axis=1))


def test_none_is_closed_unless_asked():
    solids = [without_fan(BALL, 100)]
    assert fill_holes(solids, settings()) == (solids, [], [])


@pytest.mark.parametrize("vertex", [0, 100, 1000])
def test_a_small_hole_is_closed_by_the_polygon_of_its_border(vertex):
    torn = without_fan(BALL, vertex)
    torn.finish[:] = 4
    [mesh], repairs, defects = fill_holes([torn], FILL)
    assert len(bad_edges(mesh.faces)) == 0  # closed, and wound as its neighbors are
    border = int((build_edges(torn.faces).face_count == 1).sum())
    assert len(mesh.faces) == len(torn.faces) + border - 2
    assert set(mesh.finish) == {4}
    # A lid cuts off the cap that the hole took; the ball has 5120 faces, the cap six.
    assert 1 - 6 / 5120 < volume(mesh) / volume(BALL) < 1
    assert repairs[0].startswith("holes closed with flat lids: 1, 0.")
    assert defects == []


def test_large_holes_stay_and_are_counted():
    solids = [select_faces(box((0.6, 0.6, 0.5)), slice(2, None))]
    filled, repairs, defects = fill_holes(solids, FILL)
    np.testing.assert_array_equal(filled[0].faces, solids[0].faces)
    assert repairs == []
    assert defects[0].startswith("open borders left: 1, which are wider than 0.1 of the diagonal")


def sheet(n=40):
    """A flat square of side 0.7, wound upwards, and the row and column of each face's cell."""
    x, y = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    vertices = np.stack([x, y, 0 * x], -1).reshape(-1, 3) * 0.7 / n
    cell = ((n + 1) * x + y)[:-1, :-1].ravel()
    halves = ((0, n + 1, n + 2), (0, n + 2, 1))
    faces = np.concatenate([cell[:, None] + np.array(half) for half in halves]).astype(np.int32)
    return Mesh.with_one_appearance(vertices, faces), np.divmod(np.tile(np.arange(n * n), 2), n)


@pytest.mark.parametrize("turn", range(4))
def test_a_lid_over_a_hole_with_a_notch_covers_the_hole_alone(turn):
    mesh, (row, column) = sheet()
    dent = {0: row < 12, 1: row > 12, 2: column < 12, 3: column > 12}[turn]
    hole = (abs(row - 12) < 2) & (abs(column - 12) < 2) & ~(dent & (row == column))
    torn = select_faces(mesh, ~hole)
    [filled], repairs, _ = fill_holes([torn], FILL)
    assert len(repairs) == 1
    up = double_area_normals(filled.vertices, filled.faces)[:, 2] / 2
    assert (up > 0).all()  # no lid lies the wrong way round
    assert up.sum() == pytest.approx(0.49, rel=1e-12)  # none lies over the sheet


def test_borders_that_meet_in_a_vertex_stay():
    """Which way round they go is not known."""
    mesh, (row, column) = sheet()
    hole = (row == column) & ((row == 12) | (row == 13))
    torn = select_faces(mesh, ~hole)
    loops = sorted(len(loop) for loop, _ in border_loops(torn) if len(loop) >= 3)
    assert loops == [4 * 40]  # that of the sheet itself
    filled, repairs, defects = fill_holes([torn], FILL)
    np.testing.assert_array_equal(filled[0].faces, torn.faces)
    assert repairs == []
    assert defects[0].startswith("open borders left: 2")
