"""Targets against solids whose inside is known."""

import numpy as np
import pytest
import trimesh

from industnerf.learning.targets import (
    NEAR,
    PADDING,
    OccupancyPool,
    connected_shells,
    contains_points,
    filled_shares,
    occupancy_grid,
    sample_occupancy,
    stratum_sizes,
    surface_points,
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


def grid_points(size):
    """Centers of the cells of the unit cube."""
    return (np.moveaxis(np.indices((size,) * 3), 0, -1).reshape(-1, 3) + 0.5) / size - 0.5


def hollow():
    """A box with a cavity, and two boxes that share some of their space and some of their faces."""
    vertices, faces = boxes(((0.31, 0.9, 0.9), -0.3), ((0.15, 0.3, 0.3), -0.3))
    faces[12:] = faces[12:, ::-1]  # the inner box looks inwards
    others, more_faces = boxes(
        ((0.2, 0.3, 0.3), 0.1), ((0.2, 0.3, 0.3), 0.25), ((0.1, 0.3, 0.3), 0.4)
    )
    return np.concatenate([vertices, others]), np.concatenate([faces, more_faces + len(vertices)])


def tilted(mesh):
    """Turned and shifted, so that nothing lies along the grid."""
    turn = trimesh.transformations.rotation_matrix(0.4, [1.0, 2.0, 3.0])[:3, :3]
    return 0.6 * mesh[0] @ turn + [0.01, 0.02, -0.03], mesh[1]


@pytest.mark.parametrize(
    "mesh",
    [tilted(ball()), tilted(tube()), tilted(hollow()), hollow()],
    ids=["ball", "tube", "hollow", "hollow along the grid"],
)
def test_a_grid_is_filled_where_its_centers_are_inside(mesh):
    full = occupancy_grid(*mesh, 24)
    # rays are 1e-5 beside the centers at most: no center here is as near to a face
    np.testing.assert_array_equal(full.ravel(), contains_points(*mesh, grid_points(24)))
    assert 0.01 < full.mean() < 0.5


def test_a_grid_knows_its_axes():
    vertices, faces = ball(0.1)
    full = occupancy_grid(vertices + np.array([-0.3, 0.1, 0.35]), faces, 40)
    np.testing.assert_allclose(
        grid_points(40)[full.ravel()].mean(axis=0), [-0.3, 0.1, 0.35], atol=1e-3
    )


def test_a_missing_face_spoils_no_row_of_a_grid():
    vertices, faces = ball()
    whole, torn = (occupancy_grid(vertices, some, 32) for some in (faces, faces[1:]))
    assert (whole == torn).all()


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (ball(), np.pi / 6),
        (tube(), np.pi * (0.5**2 - 0.3**2)),
        (hollow(), 0.31 * 0.9**2 - 0.15 * 0.3**2 + 0.45 * 0.3**2),
    ],
    ids=["ball", "tube", "hollow"],
)
def test_voxels_hold_the_volume(mesh, volume):
    filled = filled_shares(*tilted(mesh), 32)
    # Of 64^3 points the 10 000 or fewer in cells of the surface are in or out by chance: 4
    # deviations of 0.3 of a cell each are 5e-4.  Facets of the ball are 0.4 % of its volume inside.
    assert filled.mean() / 255 == pytest.approx(0.6**3 * volume, abs=5e-4 + 0.004 * 0.6**3 * volume)
    assert (filled.shape, filled.dtype) == ((32, 32, 32), np.uint8)


def test_a_voxel_is_as_full_as_the_share_of_it_that_is_solid():
    """Voxels of 1/4; the box ends half way in one along x, a quarter of all in y and z."""
    vertices, faces = boxes(((0.76, 1.0, 0.5), 0.0))
    along = np.array([128, 255, 255, 128])
    expected = np.broadcast_to(along[:, None, None], (4, 4, 4)) * np.array([0, 1, 1, 0])
    np.testing.assert_array_equal(filled_shares(vertices, faces, 4), expected)


def test_surface_points_are_on_the_surface():
    points = surface_points(*ball(), 1000, np.random.default_rng(0))
    # Faces of the icosphere sag below its radius by at most 0.2 %.
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 0.5, atol=1.5e-3)


CUBE_VOLUME = (1 + PADDING) ** 3
TUBE_VOLUME = np.pi * (0.5**2 - 0.3**2)


def distance_to_tube(points):
    """To its surface, of points outside of its wall."""
    radius, z = np.hypot(points[:, 0], points[:, 1]), np.abs(points[:, 2])
    aside = np.maximum(np.abs(radius - 0.4) - 0.1, 0)
    return np.hypot(aside, np.maximum(z - 0.5, 0))


@pytest.fixture(scope="module")
def tube_pool():
    return sample_occupancy(*tube(), 20000, np.random.default_rng(0))


def test_a_pool_is_half_inside_a_quarter_near_and_a_quarter_far(tube_pool):
    sizes = stratum_sizes(20000)
    assert sizes == (10000, 5000, 5000)
    inside, near, far = np.split(tube_pool.points.astype(float), np.cumsum(sizes)[:2])
    # float16 moves a point by up to 2^-12, and the polygon of the tube is within 1.5e-4 of it
    assert in_tube(inside, -4e-4).all()
    assert not in_tube(np.concatenate([near, far]), 4e-4).any()
    assert distance_to_tube(near).max() < NEAR + 4e-4
    # of 16 384 samples on an area of 6 one is seldom farther than 0.02 from a point of the surface
    assert (distance_to_tube(far) > np.sqrt(NEAR**2 - 0.02**2)).mean() > 0.999
    assert 0.54 < np.abs(tube_pool.points).max() < 0.5502


def test_shares_are_those_of_the_volume(tube_pool):
    assert tube_pool.shares.sum() == pytest.approx(1, abs=1e-6)
    # 4 standard deviations of 80 000 draws are 0.7 %
    assert tube_pool.shares[0] == pytest.approx(TUBE_VOLUME / CUBE_VOLUME, abs=0.007)


@pytest.mark.parametrize(
    ("function", "mean"),
    [
        (lambda points, inside: inside * 1.0, TUBE_VOLUME / CUBE_VOLUME),
        (lambda points, inside: (points**2).sum(axis=1), 3 * (1 + PADDING) ** 2 / 12),
        # over an annulus the mean of x^2 is a quarter of the sum of its squared radii
        (
            lambda points, inside: inside * points[:, 0] ** 2,
            TUBE_VOLUME / CUBE_VOLUME * (0.5**2 + 0.3**2) / 4,
        ),
        (lambda points, inside: np.where(inside, 1.0, points[:, 2]), TUBE_VOLUME / CUBE_VOLUME),
    ],
    ids=["inside", "square", "inside square", "inside or height"],
)
def test_weighted_means_over_draws_are_those_over_the_cube(tube_pool, function, mean):
    rng = np.random.default_rng(1)
    values = []
    for _ in range(400):
        points, inside, weights = tube_pool.draw(256, rng)
        values.append((weights * function(points, inside)).mean())
    # of the mean over the draws, and of the pool: 80 000 uniform points, 20 000 of them kept
    deviation = np.std(values) * (1 / 20 + np.sqrt(256 / 20000))
    assert np.mean(values) == pytest.approx(mean, abs=4 * deviation + 0.003)


def test_a_draw_has_its_strata_and_weights_of_mean_1(tube_pool):
    points, inside, weights = tube_pool.draw(102, np.random.default_rng(1))
    assert (points.shape, points.dtype) == ((102, 3), np.float32)
    assert inside.tolist() == [*52 * [True], *50 * [False]]
    assert weights.mean() == pytest.approx(1, rel=1e-6)
    assert len(np.unique(weights)) == 3
    assert in_tube(points[:52], -4e-4).all()
    assert not in_tube(points[52:], 4e-4).any()


def test_what_has_no_inside_counts_for_nothing():
    """A sheet: half of every draw is said to be inside, without weight."""
    sheet = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0]]), np.array([[0, 1, 2]])
    pool = sample_occupancy(*sheet, 400, np.random.default_rng(0))
    _, inside, weights = pool.draw(40, np.random.default_rng(1))
    assert pool.shares[0] == 0
    assert not weights[inside].any()
    assert weights.mean() == pytest.approx(1, rel=1e-6)


def test_a_thin_plate_is_drawn_as_often_as_a_ball():
    """It fills 0.4 % of the cube: of 256 uniform points one would be inside."""
    plate = trimesh.creation.box((1.0, 1.0, 0.005))
    mesh = np.asarray(plate.vertices), np.asarray(plate.faces)
    pool = sample_occupancy(*mesh, 4096, np.random.default_rng(0))
    assert isinstance(pool, OccupancyPool)
    # float16 moves what is so near to 0 by far less than its thickness
    assert (np.abs(pool.points[:2048, 2]) < 0.0026).all()
    assert len(np.unique(pool.points[:2048], axis=0)) > 40
    assert pool.shares[0] == pytest.approx(0.005 / CUBE_VOLUME, rel=0.5)


def test_shells_are_the_pieces_that_hang_together():
    _, faces = boxes(((1, 1, 1), 0), ((1, 1, 1), 2), ((1, 1, 1), 4))
    order = np.random.default_rng(0).permutation(len(faces))
    assert sorted(sorted(np.unique(shell)) for shell in connected_shells(faces[order])) == [
        list(range(8)),
        list(range(8, 16)),
        list(range(16, 24)),
    ]
