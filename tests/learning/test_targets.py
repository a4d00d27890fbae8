"""Targets against solids whose inside is known."""

import numpy as np
import pytest
import trimesh

from industnerf.learning.targets import (
    connected_shells,
    contains_points,
    sample_occupancy,
    surface_points,
    voxelize,
)


def ball(radius=0.5):
    mesh = trimesh.creation.icosphere(4, radius)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def tube():
    """Outer radius 0.5, inner 0.3, height 1."""
    mesh = trimesh.creation.annulus(0.3, 0.5, 1.0, sections=128)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def in_tube(points, slack=0.0):
    radius = np.hypot(points[:, 0], points[:, 1])
    return (radius > 0.3 + slack) & (radius < 0.5 - slack) & (np.abs(points[:, 2]) < 0.5 - slack)


def test_inside_of_a_tube_is_its_wall():
    points = np.random.default_rng(0).uniform(-0.55, 0.55, (20000, 3))
    is_inside = contains_points(*tube(), points)
    # The polygon of 128 sides lies within 0.5 (1 - cos(pi / 128)) = 1.5e-4 of the circles.
    surely_inside, surely_outside = in_tube(points, 2e-4), ~in_tube(points, -2e-4)
    assert is_inside[surely_inside].all()
    assert not is_inside[surely_outside].any()


def boxes(*sizes_and_places):
    """Boxes of the given edges (x, y, z) about places on the x axis, as one mesh."""
    result = [
        trimesh.creation.box(size, trimesh.transformations.translation_matrix((x, 0, 0)))
        for size, x in sizes_and_places
    ]
    mesh = trimesh.util.concatenate(result)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


@pytest.mark.parametrize("length", [0.5, 0.6], ids=["touch", "overlap"])
def test_what_two_bodies_share_is_inside(length):
    size = (length, 0.4, 0.4)
    mesh = boxes((size, -0.25), (size, 0.25))
    points = np.random.default_rng(1).uniform(-0.6, 0.6, (5000, 3))
    truth = (np.abs(points) < [0.25 + length / 2, 0.2, 0.2]).all(axis=1)
    assert (contains_points(*mesh, points) == truth).all()


def test_a_cavity_is_outside():
    vertices, faces = boxes(((1.0, 1.0, 1.0), 0.0), ((0.5, 0.5, 0.5), 0.0))
    faces[12:] = faces[12:, ::-1]  # the inner box looks inwards
    points = np.random.default_rng(1).uniform(-0.5, 0.5, (5000, 3))
    truth = (np.abs(points) > 0.25).any(axis=1)
    assert (contains_points(vertices, faces, points) == truth).all()


def test_a_missing_face_changes_little():
    vertices, faces = ball()
    points = np.random.default_rng(2).uniform(-0.5, 0.5, (5000, 3))
    truth = np.linalg.norm(points, axis=1) < 0.497
    wrong = contains_points(vertices, faces[1:], points)[truth]
    # One of 5120 faces lets few rays through, and two of the three outvote any of them.
    assert wrong.all()


def test_voxels_hold_the_volume_and_the_surface():
    full = voxelize(*ball(), 32, np.random.default_rng(0))
    volume = full.mean()
    # The surface adds about half a voxel all round: 4 pi r^2 / 64 = 0.05.
    assert np.pi / 6 < volume < np.pi / 6 + 0.07
    assert full[16, 16, 16]
    assert not full[0, 0, 0]


def test_a_wall_thinner_than_a_voxel_is_kept():
    mesh = trimesh.creation.box((1.0, 1.0, 0.002))
    full = voxelize(np.asarray(mesh.vertices), np.asarray(mesh.faces), 16, np.random.default_rng(0))
    assert full.any(axis=2).all()
    assert full.sum() <= 2 * 16 * 16


def test_surface_points_are_on_the_surface():
    points = surface_points(*ball(), 1000, np.random.default_rng(0))
    # Faces of the icosphere sag below its radius by at most 0.2 %.
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 0.5, atol=1.5e-3)


def test_occupancies_cover_the_padded_cube():
    points, full = sample_occupancy(*ball(), 20000, 0.1, np.random.default_rng(0))
    assert np.abs(points).max() == pytest.approx(0.55, abs=1e-3)
    # Share of the ball in the cube of edge 1.1; 4 standard deviations of 20 000 draws are 1.4 %.
    assert full.mean() == pytest.approx(np.pi / 6 / 1.1**3, abs=0.014)


def test_shells_are_the_pieces_that_hang_together():
    _, faces = boxes(((1, 1, 1), 0), ((1, 1, 1), 2), ((1, 1, 1), 4))
    order = np.random.default_rng(0).permutation(len(faces))
    assert sorted(sorted(np.unique(shell)) for shell in connected_shells(faces[order])) == [
        list(range(8)),
        list(range(8, 16)),
        list(range(16, 24)),
    ]
