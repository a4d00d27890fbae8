"""Normals of solids whose smooth surface is known."""

import numpy as np
import pytest
import trimesh

from industnerf.capture.normals import corner_normals, face_normals

ONE_FACE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])


def normals_of(solid: trimesh.Trimesh, crease_deg: float) -> np.ndarray:
    return corner_normals(
        np.array(solid.vertices, float), np.array(solid.faces, np.int32), crease_deg
    )


def fan(count: int, height: float) -> tuple[np.ndarray, np.ndarray]:
    """A cone's side: `count` faces around one vertex."""
    angle = np.arange(count) * (2 * np.pi / count)
    rim = np.stack([np.cos(angle), np.sin(angle), np.zeros(count)], axis=1)
    around = np.arange(count, dtype=np.int32)
    faces = np.stack([around, (around + 1) % count, np.full(count, count)], axis=1)
    return np.vstack([rim, [[0, 0, height]]]), faces.astype(np.int32)


def test_a_box_is_sharp_all_over():
    box = trimesh.creation.box((2, 3, 4))
    expected = np.repeat(np.array(box.face_normals)[:, None], 3, axis=1)
    np.testing.assert_allclose(normals_of(box, 30.0), expected, rtol=0, atol=1e-7)


def test_how_a_quad_is_split_does_not_matter():
    """With nothing sharp, each corner of a cube has the mean of its three faces.

    The corners have one or two triangles of each face, of 90 or twice 45 degrees.
    """
    cube = trimesh.creation.box((2, 2, 2))
    expected = np.array(cube.vertices)[cube.faces] / np.sqrt(3)
    np.testing.assert_allclose(normals_of(cube, 170.0), expected, rtol=0, atol=1e-7)


def test_a_cylinder_is_round_at_its_side_and_flat_at_its_ends():
    solid = trimesh.creation.cylinder(5, 20, sections=48)
    normals, corners = normals_of(solid, 30.0), np.array(solid.vertices)[solid.faces]
    ends = np.abs(np.array(solid.face_normals)[:, 2]) > 0.5
    radial = corners[~ends] * [1, 1, 0]
    radial /= np.linalg.norm(radial, axis=2, keepdims=True)
    np.testing.assert_allclose(normals[~ends], radial, rtol=0, atol=1e-6)  # by symmetry, exact
    np.testing.assert_allclose(np.abs(normals[ends]), [[[0, 0, 1]] * 3] * ends.sum(), atol=1e-7)


def test_a_ball_is_round():
    """Any weighting is wrong by less than the angle between a face and its corners.

    Faces of this ball reach 0.05 rad; the asymmetry of a vertex's fan is a fraction of that.
    """
    ball = trimesh.creation.icosphere(subdivisions=4)
    cosine = np.einsum("mij,mij->mi", normals_of(ball, 30.0), np.array(ball.vertices)[ball.faces])
    assert np.arccos(np.clip(cosine, -1, 1)).max() < 0.01


def test_a_plane_stays_flat_where_a_fillet_begins():
    """The plane's face is 100 times as large as the fillet's: it decides the shared normal."""
    angle = np.radians(15)
    down = np.array([10 + 0.1 * np.cos(angle), 0, -0.1 * np.sin(angle)])
    vertices = np.array([[0, 0, 0], [10, 0, 0], [0, 10, 0], [10, 10, 0], down, down])
    vertices[5, 1] = 10
    faces = np.array([[0, 1, 2], [1, 3, 2], [1, 4, 3], [4, 5, 3]], np.int32)
    tilt = np.arccos(np.clip(corner_normals(vertices, faces, 30.0)[:2, :, 2], -1, 1))
    assert np.degrees(tilt.max()) < 15 / 30  # area and angle weigh at least 30 to 1


@pytest.mark.parametrize(("bend_deg", "smooth"), [(29.0, True), (31.0, False)])
def test_an_edge_is_sharp_from_the_crease_angle_on(bend_deg, smooth):
    bend = np.radians(bend_deg)
    vertices = np.array([[0, 0, 0], [0, 1, 0], [-1, 0, 0], [np.cos(bend), 0, -np.sin(bend)]])
    normals = corner_normals(vertices, np.array([[0, 1, 2], [1, 0, 3]], np.int32), 30.0)
    shared = np.allclose(normals[0, 0], normals[1, 1], rtol=0, atol=1e-6)
    assert shared == smooth


def test_sheets_that_cross_at_one_edge_stay_apart():
    """Four half-planes at one edge: opposite ones are one sheet, bent by 20 degrees."""
    angle = np.radians([0, 90, 200, 290])
    rim = np.stack([np.cos(angle), np.sin(angle), np.full(4, 0.5)], axis=1)
    vertices = np.vstack([[[0, 0, 0], [0, 0, 1]], rim])
    faces = np.array([[0, 1, 2], [0, 1, 3], [1, 0, 4], [1, 0, 5]], np.int32)
    flat = face_normals(vertices[faces])
    shared = flat[:2] + flat[2:]
    shared /= np.linalg.norm(shared, axis=1, keepdims=True)
    normals = corner_normals(vertices, faces, 30.0)
    np.testing.assert_allclose(normals[:, 2], flat, rtol=0, atol=1e-7)  # off the edge
    for end in (0, 1):
        np.testing.assert_allclose(normals[:, end], np.tile(shared, (2, 1)), rtol=0, atol=1e-7)


def test_a_vertex_of_many_faces_costs_no_more_than_its_faces():
    """Of 50 000 faces all pairs would be 1.25e9: minutes and 20 GB.  All normals are known."""
    vertices, faces = fan(50_000, 0.0)
    normals = corner_normals(vertices, faces, 30.0)
    np.testing.assert_allclose(normals, np.tile([0, 0, 1.0], (50_000, 3, 1)), rtol=0, atol=1e-6)


def test_around_the_tip_of_a_cone_all_normals_are_averaged():
    vertices, faces = fan(64, 1.0)
    tip = corner_normals(vertices, faces, 30.0)[:, 2]
    np.testing.assert_allclose(tip, np.tile([0, 0, 1.0], (64, 1)), rtol=0, atol=1e-6)


def test_an_open_sheet_has_normals():
    normals = corner_normals(ONE_FACE, np.array([[0, 1, 2]], np.int32), 30.0)
    np.testing.assert_allclose(normals, [[[0, 0, 1]] * 3], rtol=0, atol=1e-7)


def test_a_face_without_area_has_no_normal_and_harms_no_other():
    vertices = np.vstack([ONE_FACE, [[0.5, 0, 0]]])
    normals = corner_normals(vertices, np.array([[0, 1, 2], [0, 3, 1]], np.int32), 30.0)
    np.testing.assert_allclose(normals[0], [[0, 0, 1]] * 3, rtol=0, atol=1e-7)
    np.testing.assert_array_equal(normals[1], 0)
