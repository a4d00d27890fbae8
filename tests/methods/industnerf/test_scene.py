"""Cameras in the unit frame, their rays, and what is behind the part."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.geometry.cameras import project, ray_directions
from industnerf.methods.industnerf.scene import (
    estimate_background,
    make_scene,
    source_target_split,
    torch_cameras,
)
from tests.methods.industnerf.synthetic_scenes import (
    CENTER,
    CPU,
    SCENE_RADIUS,
    ball,
    make_posed_images,
    make_test_scene,
    orbit_cameras,
)

SEEDS = st.integers(0, 2**32 - 1)


@given(SEEDS)
def test_a_point_has_the_same_pixel_in_either_frame(seed):
    cameras, rng = orbit_cameras(5, 48), np.random.default_rng(seed)
    unit = rng.uniform(-0.5, 0.5, (20, 3))
    torch_cams = torch_cameras(cameras, CENTER, SCENE_RADIUS, CPU)
    for K, c2w, K_mm, c2w_mm in zip(
        torch_cams.K, torch_cams.c2w, cameras.K, cameras.c2w, strict=True
    ):
        projected, depth = project(unit, K.numpy().astype(float), c2w.numpy().astype(float))
        expected, depth_mm = project(unit * SCENE_RADIUS + CENTER, K_mm, c2w_mm)
        # K and c2w are rounded to float32, 6e-8 of numbers up to 5, seen by a focal length of 90 px
        np.testing.assert_allclose(projected, expected, rtol=0, atol=1e-4)
        np.testing.assert_allclose(depth * SCENE_RADIUS, depth_mm, rtol=1e-6)


def test_the_ball_that_cameras_frame_is_the_unit_ball():
    torch_cams = torch_cameras(orbit_cameras(7, 48), CENTER, SCENE_RADIUS, CPU)
    # AWAY is 4.1 radii; the CENTER, hundreds of mm off, is taken out before float32
    torch.testing.assert_close(torch_cams.c2w[:, :3, 3].norm(dim=1), torch.full((7,), 4.1))


def test_the_cameras_are_not_changed():
    cameras = orbit_cameras(3, 24)
    before = cameras.c2w.copy()
    torch_cameras(cameras, CENTER, SCENE_RADIUS, CPU)
    np.testing.assert_array_equal(cameras.c2w, before)


@given(SEEDS)
def test_rays_are_those_of_the_cameras(seed):
    rng, cameras = np.random.default_rng(seed), orbit_cameras(4, 40)
    view, uv = rng.integers(0, 4, 30), rng.uniform(0, 40, (30, 2))
    rays = torch_cameras(cameras, CENTER, SCENE_RADIUS, CPU).rays(
        torch.from_numpy(view), torch.from_numpy(uv).float(), torch.rand(30)
    )
    for i in range(30):
        expected = ray_directions(uv[i : i + 1], cameras.K[view[i]], cameras.c2w[view[i]])[0]
        # float32, of a matrix with an inverse in it
        np.testing.assert_allclose(rays.directions[i], expected, rtol=0, atol=2e-6)
        origin = (cameras.centers[view[i]] - CENTER) / SCENE_RADIUS
        np.testing.assert_allclose(rays.origins[i], origin, rtol=0, atol=1e-6)


def test_some_of_the_views_are_a_scene_of_their_own():
    whole = make_test_scene(ball(18.0), 5, 24)
    subset = whole[torch.tensor([3, 1])]
    assert (len(subset), len(subset.cameras)) == (2, 2)
    for a, b in ((subset.images, whole.images), (subset.background, whole.background)):
        assert torch.equal(a, b[[3, 1]])
    assert torch.equal(subset.cameras.c2w, whole.cameras.c2w[[3, 1]])


def test_a_background_that_is_given_is_taken_and_another_is_found():
    assert (make_scene(make_posed_images(ball(18.0), 3, 24, 0.2), CPU).background == 0.2).all()
    unknown = make_posed_images(ball(18.0), 3, 24, None)
    assert (make_scene(unknown, CPU).background == 1).all()


@pytest.mark.parametrize("spoiled", [0, 3, 7])  # of 16 pixels that the two rows have
def test_the_border_speaks_for_the_background_while_half_of_it_shows_it(spoiled):
    """An image of 8 x 2 px is all border, and its 4 corners count twice."""
    rng = np.random.default_rng(spoiled)
    images = np.full((2, 2, 8, 3), [[[[10, 20, 30]]], [[[200, 100, 0]]]], np.uint8)
    images[:, 0, 1:7][:, :spoiled] = 255
    images[:, 1, 1 : 1 + max(0, spoiled - 6)] = 255
    images[:] = images[:, :, rng.permutation(8)]
    expected = torch.tensor([[10, 20, 30], [200, 100, 0]]) / 255
    torch.testing.assert_close(
        estimate_background(torch.from_numpy(images)), expected, rtol=0, atol=0
    )


def test_the_inside_of_an_image_has_no_say_in_its_background():
    images = torch.full((1, 20, 20, 3), 77, dtype=torch.uint8)
    images[:, 1:-1, 1:-1] = 3
    assert (estimate_background(images) == 77 / 255).all()


@pytest.mark.parametrize("count", [1, 2, 7, 40])
def test_disjoint_views_are_sources_or_targets(count):
    views, split = range(count), source_target_split("disjoint")
    source, target = set(views[split.source]), set(views[split.target])
    assert not source & target
    assert source | target == set(views)
    assert len(source) - len(target) in (0, 1)


def test_all_views_are_sources_and_targets_by_default():
    split = source_target_split("same_as_source")
    assert list(range(7)[split.source]) == list(range(7)[split.target]) == list(range(7))
