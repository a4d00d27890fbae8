"""Surface samples are on the surface, and equally likely everywhere on it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.geometry.sampling import ball_surface, box_surface, sample_surface

SEEDS = st.integers(0, 2**32 - 1)
N = 40_000


def soup(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Ten triangles of very unequal areas, 500 mm from the origin."""
    rng = np.random.default_rng(seed)
    vertices = rng.uniform(-1, 1, (30, 3)) * np.repeat(rng.uniform(1, 30, (10, 1)), 3, axis=0)
    return vertices + 500, np.arange(30, dtype=np.int32).reshape(10, 3)


def barycentric(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Weights of the three corners, by least squares, and what they leave unexplained."""
    edges = np.moveaxis(triangles[:, 1:] - triangles[:, :1], 1, 2)
    weights = np.einsum("nij,nj->ni", np.linalg.pinv(edges), points - triangles[:, 0])
    left = points - triangles[:, 0] - np.einsum("nij,nj->ni", edges, weights)
    return np.column_stack([1 - weights.sum(axis=1), weights, np.linalg.norm(left, axis=1)])


@given(SEEDS)
def test_each_point_lies_within_the_face_it_names(seed):
    vertices, faces = soup(seed)
    points, face = sample_surface(vertices, faces, 200, np.random.default_rng(seed))
    result = barycentric(points, vertices[faces[face]])
    assert points.dtype == np.float64
    # positions near 500 mm are rounded by 1e-13 mm; the thinnest triangles magnify that
    assert (result[:, :3] > -1e-9).all()
    assert (result[:, 3] < 1e-9).all()


def test_faces_get_points_by_their_area():
    vertices, faces = soup(1)
    a, b, c = vertices[faces].transpose(1, 0, 2)
    share = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    share /= share.sum()
    _, face = sample_surface(vertices, faces, N, np.random.default_rng(0))
    z = (np.bincount(face, minlength=10) - N * share) / np.sqrt(N * share * (1 - share))
    assert np.abs(z).max() < 4  # by chance once in 1600 seeds


def test_points_are_uniform_within_a_face():
    """Barycentric weights of a uniform point are Dirichlet(1, 1, 1)."""
    vertices = np.array([[0, 0, 0], [7, 0, 0], [1, 3, 2.0]])
    points, _ = sample_surface(
        vertices, np.array([[0, 1, 2]], np.int32), N, np.random.default_rng(0)
    )
    weights = barycentric(points, np.tile(vertices, (N, 1, 1)))[:, :3]
    # mean 1/3 with standard deviation 1/sqrt(18); P(weight > 1/2) = 1/4: each within 4 errors
    assert np.abs(weights.mean(axis=0) - 1 / 3).max() < 4 / np.sqrt(18 * N)
    assert np.abs((weights > 0.5).mean(axis=0) - 0.25).max() < 4 * np.sqrt(3 / 16 / N)


def test_the_generator_decides():
    vertices, faces = soup(2)
    one, same, other = (
        sample_surface(vertices, faces, 10, np.random.default_rng(seed))[0] for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)


def test_faces_without_area_are_never_chosen():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0.0]])
    faces = np.array([[0, 1, 3], [0, 1, 2], [3, 3, 2]], np.int32)
    _, face = sample_surface(vertices, faces, 1000, np.random.default_rng(0))
    assert set(face) == {1}


def test_a_mesh_without_area_is_refused():
    with pytest.raises(ValueError, match="1 faces and no area"):
        sample_surface(
            np.zeros((3, 3)), np.array([[0, 1, 2]], np.int32), 5, np.random.default_rng(0)
        )


EXTENTS, CENTER = np.array([3.0, 8.0, 20.0]), np.array([100.0, -50.0, 7.0])


def test_the_ball_has_the_mean_extent_for_its_diameter():
    points = ball_surface(EXTENTS, CENTER, N, np.random.default_rng(0))
    radius = np.linalg.norm(points - CENTER, axis=1)
    np.testing.assert_allclose(radius, (3 + 8 + 20) / 3 / 2, rtol=1e-12)


def test_the_ball_is_uniform():
    """Along any axis a uniform sphere is uniform (Archimedes' hat box)."""
    points = ball_surface(EXTENTS, CENTER, N, np.random.default_rng(0)) - CENTER
    unit = points / np.linalg.norm(points, axis=1, keepdims=True)
    axes = np.vstack([np.eye(3), np.ones(3) / np.sqrt(3)])
    for along in (unit @ axes.T).T:
        counts, _ = np.histogram(along, 20, (-1, 1))
        z = (counts - N / 20) / np.sqrt(N / 20 * 0.95)
        assert np.abs(z).max() < 4  # of 80 counts, by chance once in 200 seeds


def test_every_point_of_the_box_is_on_one_of_its_faces():
    points = box_surface(EXTENTS, CENTER, N, np.random.default_rng(0))
    beyond = np.abs(points - CENTER) - EXTENTS / 2
    np.testing.assert_allclose(beyond.max(axis=1), 0, atol=1e-12)


def test_the_box_is_uniform():
    """Six faces, by area, and the four quarters of each."""
    points = (box_surface(EXTENTS, CENTER, N, np.random.default_rng(0)) - CENTER) / EXTENTS
    face = np.abs(points).argmax(axis=1)
    side, across = points[np.arange(N), face] > 0, (face[:, None] + [1, 2]) % 3
    quarter = np.take_along_axis(points, across, axis=1) > 0
    cell = np.ravel_multi_index((face, side, *quarter.T), (3, 2, 2, 2))
    share = np.repeat(1 / EXTENTS / (1 / EXTENTS).sum() / 8, 8)
    z = (np.bincount(cell, minlength=24) - N * share) / np.sqrt(N * share * (1 - share))
    assert np.abs(z).max() < 4  # by chance once in 650 seeds


def test_a_flat_box_has_two_faces_and_a_line_none():
    points = box_surface(np.array([3.0, 8.0, 0.0]), CENTER, 1000, np.random.default_rng(0))
    np.testing.assert_array_equal(points[:, 2], CENTER[2])
    assert np.ptp(points, axis=0)[:2] == pytest.approx([3, 8], rel=0.05)
    with pytest.raises(ValueError, match="no surface"):
        box_surface(np.array([3.0, 0.0, 0.0]), CENTER, 10, np.random.default_rng(0))
