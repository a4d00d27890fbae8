"""Signed distances on a grid: exact ones, the hull's, and those resampled from points."""

import numpy as np
import pytest
import warp as wp

from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf_plus.distance_grid import (
    COARSE_RES,
    FILL_VALUE,
    MAX_GRID_RES,
    MIN_CELL_PX,
    PADDING,
    DistanceGrid,
    band_nodes,
    choose_grid_res,
    fill_enclosed_air,
    from_points,
    hull_box,
    hull_grid,
    node_neighbors,
    redistance,
    snap_to_hull,
)
from industnerf.methods.industnerf_plus.grid_kernels import start_near_zero
from industnerf.photohull.voxel_grid import UnitFrameCameras

NODES = np.stack(np.meshgrid(*[np.arange(40.0)] * 3, indexing="ij"), axis=-1)
CENTER = np.array([19.3, 20.1, 19.8])
RADIUS = 11.0
BALL = (np.linalg.norm(NODES - CENTER, axis=-1) - RADIUS).astype(np.float32)


@pytest.mark.parametrize("distortion", [lambda s: s, lambda s: 3 * s, lambda s: s + 0.1 * s**3])
def test_redistancing_gives_distances_of_the_same_surface(distortion):
    """To first order in the cell: a tenth of a cell near the surface, half of one farther off."""
    distance = redistance(distortion(BALL), 8.0)
    near, far = np.abs(BALL) < 1, np.abs(BALL) < 6
    assert np.abs(distance - BALL)[near].max() < 0.15
    assert np.abs(distance - BALL)[far].max() < 0.5
    assert ((distance > 0) == (BALL > 0)).all()
    assert np.abs(distance).max() <= 8


def test_a_plane_keeps_its_exact_distances():
    plane = (NODES[..., 0] - 17.25).astype(np.float32)
    np.testing.assert_allclose(redistance(plane, 30.0), plane, atol=1e-4)


def test_all_nodes_have_the_distances_that_a_slow_loop_finds_up_to_the_border():
    """Of rough values, whose zero set meets all six sides of the grid."""
    values = np.random.default_rng(0).normal(size=(7, 9, 11)).astype(np.float32)
    values += np.linspace(-3, 5, 11, dtype=np.float32)
    start, is_fixed = (
        wp.empty(values.shape, dtype, device="cpu") for dtype in (wp.float32, wp.uint8)
    )
    source = wp.array(values, dtype=wp.float32, device="cpu")
    wp.launch(start_near_zero, values.shape, [source], [start, is_fixed], device="cpu")
    expected = slow_distances(start.numpy(), is_fixed.numpy() > 0)
    assert 0.1 < is_fixed.numpy().mean() < 0.6
    np.testing.assert_allclose(np.abs(redistance(values)), expected, rtol=0, atol=1e-5)


def slow_distances(start, is_fixed):
    """Of |grad d| = 1 in float64: the nodes in turn, until none comes nearer."""
    distance = np.pad(np.where(is_fixed, start, np.inf), 1, constant_values=np.inf)
    while True:
        before = distance.copy()
        for i, j, k in np.argwhere(~is_fixed) + 1:
            a = distance[[i - 1, i + 1], j, k].min()
            b = distance[i, [j - 1, j + 1], k].min()
            c = distance[i, j, [k - 1, k + 1]].min()
            distance[i, j, k] = min(distance[i, j, k], nearest_root(np.sort([a, b, c])))
        if np.array_equal(before, distance):
            return distance[1:-1, 1:-1, 1:-1]


def nearest_root(neighbors):
    """The x with sum_n (x - d_n)^2 = 1 over the neighbors d_n < x, which are sorted."""
    x = np.inf
    for number in (1, 2, 3):
        if not neighbors[number - 1] < x:
            break
        mean, square = neighbors[:number].mean(), (neighbors[:number] ** 2).mean()
        x = mean + np.sqrt(max(1 / number - square + mean**2, 0))
    return x


def test_near_the_hull_the_surface_snaps_to_it_and_farther_away_it_stays():
    depth = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0], np.float32)[:, None, None]
    hull = np.full_like(depth, -2.0)
    gap = (snap_to_hull(hull + depth, hull) - hull).ravel()
    np.testing.assert_allclose(gap, [0, 0, 0, 1, 2, 3])


def test_air_that_no_way_leads_to_is_filled():
    outer = BALL
    bubble = RADIUS - 6 - np.linalg.norm(NODES - CENTER, axis=-1)
    shaft = 2.5 - np.linalg.norm((NODES - CENTER)[..., :2], axis=-1)
    shaft = np.where(NODES[..., 2] > CENTER[2], shaft, -9)
    closed = np.maximum(outer, bubble).astype(np.float32)
    opened = np.maximum(closed, shaft).astype(np.float32)
    middle = tuple(CENTER.round().astype(int))
    assert closed[middle] > 0
    assert fill_enclosed_air(closed)[middle] == FILL_VALUE
    np.testing.assert_array_equal(fill_enclosed_air(opened) > 0, opened > 0)


def test_points_of_a_finer_frame_give_the_surface_they_have():
    """Half a cell of the points at most; the points have 0.08, the grid 0.05."""
    spacing, cell = 0.08, 0.05
    axis = np.arange(-1 + spacing / 2, 1, spacing)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    distance = np.linalg.norm(points, axis=1) - 0.5
    is_kept = distance < 0.3
    lo = np.full(3, -0.975)
    nodes = lo + cell * NODES
    hull = ((np.linalg.norm(nodes, axis=-1) - 0.65) / cell).astype(np.float32)
    empty = DistanceGrid(hull.copy(), hull, lo, cell)
    grid = from_points(
        empty,
        points[is_kept].astype(np.float32),
        distance[is_kept].astype(np.float32),
        spacing,
    )
    true = (np.linalg.norm(nodes, axis=-1) - 0.5) / cell
    assert np.abs(grid.distance - true)[np.abs(true) < 2].max() < 0.5 * spacing / cell
    assert (grid.distance >= grid.hull).all()


def cameras(diameter_px: float) -> UnitFrameCameras:
    return UnitFrameCameras(
        np.zeros((1, 3, 4), np.float32),
        np.array([[0.0, 0.0, -4.0]], np.float32),
        np.array([2 * diameter_px], np.float32),
        np.zeros(3),
        1.0,
    )


def box_depth(*extents: int) -> np.ndarray:
    depth = np.full((COARSE_RES,) * 3, -9.0, np.float32)
    depth[tuple(slice(32 - e // 2, 32 + e // 2) for e in extents)] = 1.0
    return np.pad(depth, PADDING, constant_values=-9.0)


def test_a_slender_part_gets_smaller_cells_than_a_cube_and_none_below_two_pixels():
    cube, rod = box_depth(40, 40, 40), box_depth(56, 8, 8)
    fine = cameras(10_000)
    for depth in (cube, rod):
        grid_res = choose_grid_res(depth, fine, 500_000)
        extents = [stop - start - 2 * PADDING for start, stop in hull_box(depth)]
        nodes = np.prod(np.array(extents) * grid_res / COARSE_RES + 2 * PADDING)
        assert nodes <= 500_000
    assert choose_grid_res(cube, fine, 500_000) < choose_grid_res(rod, fine, 500_000)
    assert choose_grid_res(rod, fine, 10**9) == MAX_GRID_RES
    assert choose_grid_res(rod, cameras(100), 10**9) <= 100 / MIN_CELL_PX


def test_a_part_that_fills_the_frame_does_not_touch_the_border_of_the_grid():
    """Distances of masks that show the part everywhere: the hull is all of the cube."""
    rig = UnitFrameCameras(
        np.array([[[64, 0, 32, 128], [0, 64, 32, 128], [0, 0, 1, 4]]], np.float32),
        np.array([[0.0, 0.0, -4.0]], np.float32),
        np.array([64.0], np.float32),
        np.zeros(3),
        1.0,
    )
    grid = hull_grid(np.full((1, 64, 64), 11.0, np.float32), rig, 100_000)
    border = np.ones(grid.hull.shape, bool)
    border[3:-3, 3:-3, 3:-3] = False
    assert (grid.hull[border] > 0).all()
    inside = np.argwhere(grid.hull < 0)
    corners = grid.from_grid(np.stack([inside.min(axis=0), inside.max(axis=0)]).astype(float))
    np.testing.assert_allclose(corners, [[-1] * 3, [1] * 3], atol=1.01 * grid.spacing)


def test_a_part_that_fills_the_frame_keeps_to_the_budget_too():
    whole = box_depth(64, 64, 64)
    grid_res = choose_grid_res(whole, cameras(10_000), 500_000)
    assert (grid_res + 2 * PADDING) ** 3 <= 500_000
    assert grid_res > 48


def test_an_empty_hull_is_refused():
    with pytest.raises(ReconstructionFailed, match="nothing in common"):
        hull_box(np.full((8, 8, 8), -2.0, np.float32))


def test_the_neighbors_of_a_node_are_one_cell_away():
    nodes = band_nodes(BALL, 2.0)
    assert (np.abs(BALL[tuple(nodes.T)]) < 2).all()
    neighbors = node_neighbors(nodes, BALL.shape)
    steps = np.concatenate([s * np.eye(3, dtype=int)[[a]] for a in range(3) for s in (1, -1)])
    for column, step in zip(neighbors.T, steps, strict=True):
        has_one = column >= 0
        np.testing.assert_array_equal(nodes[column[has_one]], nodes[has_one] + step)
        beyond = nodes[~has_one] + step
        assert (np.abs(BALL[tuple(beyond.T)]) >= 2).all()
