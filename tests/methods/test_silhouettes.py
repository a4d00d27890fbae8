"""Distance images of silhouettes against their slow twins."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt, gaussian_filter, map_coordinates

from industnerf.geometry.cameras import project
from industnerf.geometry.silhouettes import MAX_DISTANCE_PX, distance_to_mask, signed_distance
from industnerf.methods.hull.silhouettes import bilinear, distance_images
from tests.methods.solids import cameras_around, masks_of_ball

SEEDS = st.integers(0, 2**32 - 1)
BLUR_PX = st.sampled_from([0.0, 1.0, 4.0])  # from salt and pepper to large smooth blobs


def blobs(seed: int, blur_px: float, shape: tuple[int, int] = (48, 40)) -> np.ndarray:
    noise = np.random.default_rng(seed).standard_normal(shape)
    return gaussian_filter(noise, blur_px) > 0


@given(SEEDS, BLUR_PX)
def test_distances_are_those_of_scipy_up_to_the_limit(seed, blur_px):
    target = blobs(seed, blur_px) & blobs(seed + 1, 0) & blobs(seed + 2, 0)
    target[0, 0] = True  # scipy knows no distance to nothing
    expected = np.minimum(distance_transform_edt(~target), MAX_DISTANCE_PX)
    # both are roots of the same whole number, one in float32
    np.testing.assert_allclose(distance_to_mask(target), expected, rtol=1e-7)


def test_the_distance_to_nothing_is_the_limit():
    np.testing.assert_array_equal(
        distance_to_mask(np.zeros((5, 30), bool)), np.float32(MAX_DISTANCE_PX)
    )


def test_the_outline_runs_half_way_between_unlike_pixels():
    mask = np.zeros((9, 16), bool)
    mask[:, 6:] = True
    # exactly representable: halves of whole numbers
    np.testing.assert_array_equal(signed_distance(mask), np.tile(np.arange(16.0) - 5.5, (9, 1)))


@given(SEEDS)
def test_bilinear_is_that_of_scipy_and_goes_on_beyond_the_frame(seed):
    rng = np.random.default_rng(seed)
    image = rng.standard_normal((7, 11)).astype(np.float32)
    u, v = rng.uniform(-3, 13, (2, 500)).astype(np.float32)
    expected = map_coordinates(image, [v, u], order=1, mode="nearest")
    # The last pixel's center is approached to 0.001 px, over which values change by 0.01 at most.
    inner = (u < 9.9) & (v < 5.9)
    np.testing.assert_allclose(bilinear(image, u, v), expected, atol=0.01)
    np.testing.assert_allclose(bilinear(image, u, v)[inner], expected[inner], atol=1e-5)


@given(SEEDS, BLUR_PX)
def test_a_distance_is_overstated_by_less_than_a_tenth_of_a_pixel(seed, blur_px):
    """So a verdict on a cell errs by a sliver of that width at most.

    Between four unlike pixels the interpolation can rise faster than 1 px per px.
    """
    distance = signed_distance(blobs(seed, blur_px))
    rng = np.random.default_rng(seed)
    u, v, angle = rng.uniform([2, 2, 0], [37, 45, 2 * np.pi], (5000, 3)).T
    r = rng.uniform(0, 6, 5000)
    here = bilinear(distance, u.astype(np.float32), v.astype(np.float32))
    there = (u + r * np.cos(angle), v + r * np.sin(angle))
    there = bilinear(distance, *(x.astype(np.float32) for x in there))
    unlike = (here > 0) != (there > 0)
    assert (np.abs(here)[unlike] <= r[unlike] + 0.1).all()


@pytest.mark.parametrize("center", [(0, 0, 0), (300, -20, 7)])
def test_points_project_as_the_cameras_say(center):
    cameras = cameras_around(7, 64, radius=25.0, center=center)
    silhouettes = distance_images(np.ones((7, 64, 64), bool), cameras, 0.0)
    unit = np.random.default_rng(0).uniform(-0.5, 0.5, (20, 3))
    for view in range(7):
        u, v, depth = silhouettes.projection[view] @ np.column_stack([unit, np.ones(20)]).T
        uv, depth_mm = project(
            silhouettes.center + silhouettes.radius_mm * unit, cameras.K[view], cameras.c2w[view]
        )
        # float32 knows coordinates of 64 px to 4e-6 px; sums of four such products to 1e-4
        np.testing.assert_allclose(np.stack([u, v] / depth, axis=1), uv - 0.5, atol=1e-4)
        np.testing.assert_allclose(depth * silhouettes.radius_mm, depth_mm, rtol=1e-6)


@pytest.mark.parametrize("view", range(3))
def test_no_step_moves_the_image_by_more_than_its_stretch(view):
    cameras = cameras_around(3, 64, radius=25.0)
    silhouettes = distance_images(masks_of_ball(20.0, cameras), cameras, 0.0)
    rng = np.random.default_rng(view)
    ends = rng.standard_normal((2000, 3))
    ends *= (rng.uniform(0, 1.2, 2000) / np.linalg.norm(ends, axis=1))[:, None]
    step = 0.05 * rng.standard_normal((2000, 3))
    points = np.stack([ends, ends + step]) @ silhouettes.projection[view, :, :3].T
    points += silhouettes.projection[view, :, 3]
    moved = np.linalg.norm(np.diff(points[..., :2] / points[..., 2:], axis=0)[0], axis=1)
    length, depth = np.linalg.norm(step, axis=1), points[0, :, 2]
    # 1e-4 px: float32, as above
    assert (moved <= silhouettes.max_focal_px[view] * length / (depth - length) + 1e-4).all()
