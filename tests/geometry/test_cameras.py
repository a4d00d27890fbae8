"""Pixels, rays and points agree with each other and with the stated convention."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.geometry.cameras import (
    Cameras,
    back_projection,
    common_view_ball,
    look_at,
    nested_view_order,
    nested_view_subset,
    pinhole,
    pixel_centers,
    project,
    ray_directions,
    reduced_size,
    unproject,
)
from industnerf.geometry.sphere import fibonacci_sphere

K = np.array([[600.0, 0, 320], [0, 610, 235], [0, 0, 1]])
SEEDS = st.integers(0, 2**32 - 1)
U, V = st.floats(0, 640), st.floats(0, 480)
DEPTHS = st.floats(1, 1e4)


def random_pose(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    c2w = np.eye(4)
    c2w[:3, :3] = rotation * np.sign(np.linalg.det(rotation))
    c2w[:3, 3] = rng.uniform(-500, 500, 3)
    return c2w


@given(SEEDS, U, V, DEPTHS)
def test_unprojecting_then_projecting_returns_pixel_and_depth(seed, u, v, depth):
    c2w, uv = random_pose(seed), np.array([[u, v]])
    back, z = project(unproject(uv, np.array([depth]), K, c2w), K, c2w)
    # Worst at depth 1: a position some 900 mm from the origin is rounded by 1e-13 mm, which
    # 600 px of focal length make 1e-10 px.
    np.testing.assert_allclose(back, uv, rtol=0, atol=1e-8)
    np.testing.assert_allclose(z, depth, rtol=1e-12, atol=1e-11)


@given(SEEDS, st.tuples(*[st.floats(-100, 100)] * 2), DEPTHS)
def test_projecting_then_unprojecting_returns_the_point(seed, offset, depth):
    c2w = random_pose(seed)
    point = c2w[:3, :3] @ np.array([*offset, depth]) + c2w[:3, 3]
    uv, z = project(point[None], K, c2w)
    # Up to 100 mm aside at 1 mm depth, u is 6e4 px: rounded by 1e-11 px, and back by as much.
    np.testing.assert_allclose(unproject(uv, z, K, c2w)[0], point, rtol=0, atol=1e-8)


@given(SEEDS, U, V, DEPTHS)
def test_rays_are_unit_vectors_through_their_pixels(seed, u, v, t):
    c2w, uv = random_pose(seed), np.array([[u, v]])
    direction = ray_directions(uv, K, c2w)
    assert np.linalg.norm(direction) == pytest.approx(1, abs=1e-14)
    back, z = project(c2w[:3, 3] + t * direction, K, c2w)
    assert z[0] > 0
    np.testing.assert_allclose(back, uv, rtol=0, atol=1e-8)  # as above


@given(SEEDS, U, V)
def test_back_projected_directions_count_depth(seed, u, v):
    c2w = random_pose(seed)
    along = (back_projection(K, c2w) @ [u, v, 1]) @ c2w[:3, :3]
    assert along[2] == pytest.approx(1, abs=1e-14)


def test_pixel_centers_go_row_by_row_from_the_top_left_corner():
    np.testing.assert_array_equal(
        pixel_centers(3, 2),
        [[0.5, 0.5], [1.5, 0.5], [2.5, 0.5], [0.5, 1.5], [1.5, 1.5], [2.5, 1.5]],
    )


def test_x_is_right_y_is_down_z_is_forward():
    """From +y, looking at the origin with +z upwards, world -x is on the right."""
    c2w = look_at(np.array([[0.0, 10, 0]]), np.zeros(3))[0]
    uv, z = project(np.array([[-1.0, 0, 0], [0, 0, 1], [0, 0, 0]]), pinhole(30.0, 100), c2w)
    assert uv[0, 0] > 50
    assert uv[0, 1] == pytest.approx(50, abs=1e-12)
    assert uv[1, 0] == pytest.approx(50, abs=1e-12)
    assert uv[1, 1] < 50
    np.testing.assert_allclose(z, 10, rtol=0, atol=1e-12)


def test_look_at_gives_rigid_motions_at_the_poles_too():
    camera_centers = 7 * np.vstack([fibonacci_sphere(50), [[0, 0, 1], [0, 0, -1]]]) + [1, 2, 3]
    c2w = look_at(camera_centers, np.array([1.0, 2, 3]))
    rotation = c2w[:, :3, :3]
    identity = np.broadcast_to(np.eye(3), rotation.shape)
    np.testing.assert_allclose(rotation @ rotation.transpose(0, 2, 1), identity, rtol=0, atol=1e-14)
    np.testing.assert_allclose(np.linalg.det(rotation), 1, rtol=0, atol=1e-14)
    np.testing.assert_allclose(
        camera_centers + 7 * rotation[:, :, 2], np.tile([1, 2, 3], (52, 1)), atol=1e-13
    )


def test_the_image_side_spans_the_field_of_view():
    edge = ray_directions(np.array([[0.0, 256], [512, 256]]), pinhole(40.0, 512), np.eye(4))
    assert np.degrees(np.arccos(edge[0] @ edge[1])) == pytest.approx(40, abs=1e-9)


def test_the_framed_ball_touches_the_narrowest_frame():
    camera_centers = np.array([1.0, -2, 3]) + 50 * fibonacci_sphere(9)
    cameras = Cameras(
        np.tile(pinhole(30.0, 64), (9, 1, 1)),
        look_at(camera_centers, np.array([1.0, -2, 3])),
        64,
        64,
    )
    center, radius = common_view_ball(cameras)
    np.testing.assert_allclose(center, [1, -2, 3], rtol=0, atol=1e-12)
    assert radius == pytest.approx(50 * np.sin(np.radians(15)), rel=1e-12)
    # the plane through eye and image border touches the ball: that is what `in frame` means
    border = ray_directions(np.array([[0.0, 32.0]]), cameras.K[0], cameras.c2w[0])[0]
    nearest = np.linalg.norm(np.cross(border, center - cameras.centers[0]))
    assert nearest == pytest.approx(radius, rel=1e-12)


def test_cameras_are_cut_like_arrays():
    cameras = Cameras(np.tile(K, (3, 1, 1)), np.stack([random_pose(i) for i in range(3)]), 640, 480)
    assert len(cameras) == 3
    np.testing.assert_array_equal(cameras[np.array([2, 0])].centers, cameras.centers[[2, 0]])


@pytest.mark.parametrize(
    ("size", "longest", "reduced"),
    [
        ((4000, 3000), 512, (512, 384)),
        ((3000, 4000), 512, (384, 512)),
        ((512, 512), 512, (512, 512)),
        ((100, 50), 512, (100, 50)),  # never enlarged
        ((4000, 3), 512, (512, 1)),  # never gone
    ],
)
def test_the_long_edge_is_the_limit(size, longest, reduced):
    assert reduced_size(*size, longest) == reduced


def test_each_number_includes_the_smaller_ones_and_all_are_different():
    positions = fibonacci_sphere(40)
    sets = [set(nested_view_subset(positions, count).tolist()) for count in range(1, 41)]
    assert sets[0] == {0}
    assert all(smaller < larger for smaller, larger in pairwise(sets))
    assert sets[-1] == set(range(40))


def test_the_farthest_comes_next():
    line = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [9, 0, 0], [4, 0, 0]])
    assert nested_view_subset(line, 2).tolist() == [0, 3]
    assert nested_view_subset(line, 3).tolist() == [0, 3, 4]  # 4 is 4 from the next, 2 is 2
    assert nested_view_subset(line, 4).tolist() == [0, 2, 3, 4]


@pytest.mark.parametrize("count", [4, 8, 16])
def test_few_of_a_sphere_are_spread_over_it(count):
    """The nearest two are at least half as far apart as those of a sphere's lattice."""
    chosen, even = (
        np.linalg.norm(p[:, None] - p[None], axis=2)[~np.eye(count, dtype=bool)].min()
        for p in (
            fibonacci_sphere(40)[nested_view_subset(fibonacci_sphere(40), count)],
            fibonacci_sphere(count),
        )
    )
    assert chosen > 0.5 * even


def test_places_that_coincide_are_all_taken_once():
    assert nested_view_subset(np.zeros((3, 3)), 3).tolist() == [0, 1, 2]


def test_the_first_of_an_order_of_any_length_are_the_subset_of_their_number():
    positions = fibonacci_sphere(40)
    order = nested_view_order(positions, 40)
    for count in range(1, 41):
        np.testing.assert_array_equal(order[:count], nested_view_order(positions, count))
        assert sorted(order[:count]) == nested_view_subset(positions, count).tolist()


@pytest.mark.parametrize(("count", "within_deg"), [(5, 65), (8, 62), (12, 47)])
def test_the_first_few_of_an_order_look_from_all_round(count, within_deg):
    """Whatever the side, one of them looks from no farther off; of a spiral's first none."""
    positions, directions = fibonacci_sphere(40), fibonacci_sphere(500)
    chosen, in_a_row = positions[nested_view_order(positions, count)], positions[:count]
    farthest = [
        np.degrees(np.arccos((directions @ p.T).max(axis=1).min())) for p in (chosen, in_a_row)
    ]
    assert farthest[0] < within_deg
    assert farthest[1] > 115


def test_a_rig_has_one_order_about_any_part():
    """Rings are symmetric: to rounding, which depends on the part, many views are alike far."""
    angles = 2 * np.pi * np.arange(12) / 12
    rings = np.concatenate([np.c_[np.cos(angles), np.sin(angles), 0 * angles + z] for z in (0, 1)])
    rng = np.random.default_rng(0)
    orders = {
        tuple(nested_view_order(rng.uniform(5, 200) * rings + rng.normal(size=3), 24).tolist())
        for _ in range(20)
    }
    assert len(orders) == 1
