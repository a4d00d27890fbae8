"""Which pixels are looked at: all that can show a point, and what they say."""

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.geometry.cameras import look_at, reduced_size
from industnerf.methods.industnerf.ray_sampler import (
    DEPTH_EDGE,
    RaySampler,
    add_noise,
    downsample_depth,
    downsample_images,
    footprint,
)
from industnerf.methods.industnerf.scene import NerfScene, TorchCameras
from industnerf.rendering.compiled_renderer import CompiledRenderer
from industnerf.rendering.points import PointGrid
from tests.methods.industnerf.synthetic_scenes import ball, make_test_scene

SEEDS = st.integers(0, 2**32 - 1)
HALF = torch.tensor(0.5)


def random_cameras(seed: int, count: int = 3) -> TorchCameras:
    """Wide and narrow lenses, near and far, unlike in x and y, aimed beside the middle."""
    rng = np.random.default_rng(seed)
    width, height = (int(n) for n in rng.integers(20, 60, 2))
    focal = width * np.exp(rng.uniform(-1.2, 1.2, count))
    K = np.zeros((count, 3, 3))
    K[:, 0, 0], K[:, 1, 1] = focal, focal * rng.uniform(0.7, 1.4, count)
    K[:, :2, 2] = rng.uniform(0.3, 0.7, (count, 2)) * [width, height]
    K[:, 2, 2] = 1
    centers = rng.normal(size=(count, 3))
    centers *= rng.uniform(1.3, 5, (count, 1)) / np.linalg.norm(centers, axis=1, keepdims=True)
    c2w = look_at(centers, rng.uniform(-0.4, 0.4, 3))
    return TorchCameras(torch.tensor(K).float(), torch.tensor(c2w).float(), width, height)


def pixel_center_directions(
    cameras: TorchCameras, view: int, height: int, width: int
) -> torch.Tensor:
    """Directions of the rays through the centers of an image's pixels, row by row."""
    row, column = torch.meshgrid(torch.arange(height), torch.arange(width), indexing="ij")
    scale = torch.tensor([cameras.width / width, cameras.height / height])
    uv = (torch.stack([column, row], dim=-1).reshape(-1, 2) + HALF) * scale
    views = torch.full((len(uv),), view)
    return cameras.rays(views, uv, torch.zeros(len(uv))).directions


def ray_point_distance(
    points: torch.Tensor, origin: torch.Tensor, directions: torch.Tensor
) -> torch.Tensor:
    """How near each ray comes to the points, at its nearest; float64."""
    offsets, unit_directions = (points - origin).double(), directions.double()
    t = (unit_directions @ offsets.T).clamp(min=0)
    return (offsets[None] - t[:, :, None] * unit_directions[:, None]).norm(dim=2).min(dim=1).values


@pytest.mark.parametrize("image_px", [16, 60])
@given(seed=SEEDS, radius=st.floats(0.01, 0.3), count=st.sampled_from([1, 12]))
def test_every_ray_that_meets_a_point_is_in_the_footprint(image_px, seed, radius, count):
    cameras = random_cameras(seed)
    rng = np.random.default_rng(seed)
    points = torch.tensor(rng.uniform(-1, 1, (count, 3)) * rng.uniform(0.05, 1)).float()
    visible = footprint(points, radius, cameras, image_px)
    assert tuple(visible.shape[:0:-1]) == reduced_size(cameras.width, cameras.height, image_px)
    for view in range(len(cameras)):
        center, axis = cameras.c2w[view, :3, 3], cameras.c2w[view, :3, 2]
        in_front = points[
            (points - center) @ axis > radius * (1 + 1e-5)
        ]  # others are not looked for
        if len(in_front):
            distances = ray_point_distance(
                in_front, center, pixel_center_directions(cameras, view, *visible.shape[1:])
            )
            # rays and pixels are rounded to float32: 1e-6 of distances of 5
            assert visible[view].flatten()[distances < radius - 1e-5].all()


def test_the_footprint_of_a_point_is_little_larger_than_its_ball():
    """Of 64 px and 30 degrees, 4.1 away: a square about the disc, a pixel's rounding all round."""
    cameras = make_test_scene(ball(18.0), 6, 64).cameras
    radius = 0.1
    visible = footprint(torch.zeros(1, 3), radius, cameras, 64)
    side = 2 * math.ceil(radius * cameras.K[0, 0, 0].item() / (4.1 - radius)) + 1
    assert (visible.sum(dim=(1, 2)) == side**2).all()


def test_balls_at_the_edge_of_a_wide_lens_are_drawn_out():
    """60 degrees off the axis, where a ball's image is four times as long as in the middle."""
    K = torch.tensor([[[30.0, 0, 60], [0, 30, 60], [0, 0, 1]]])
    cameras = TorchCameras(K, torch.eye(4)[None], 120, 120)
    point = torch.tensor([[3**0.5, 0.0, 1.0]])
    visible = footprint(point, 0.2, cameras, 120)
    is_near = (
        ray_point_distance(point, torch.zeros(3), pixel_center_directions(cameras, 0, 120, 120))
        < 0.2
    )
    assert is_near.sum() > 50
    assert visible.flatten()[is_near].all()


def test_no_points_have_no_footprint():
    cameras = random_cameras(0)
    assert not footprint(torch.zeros(0, 3), 0.1, cameras, 32).any()
    behind = cameras.c2w[:1, :3, 3] - cameras.c2w[:1, :3, 2]
    assert not footprint(behind, 0.1, cameras[:1], 32).any()


@pytest.mark.parametrize("weights", ["inverse_square", "trilinear"])
@given(SEEDS)
def test_beside_the_footprint_rays_see_pure_background(weights, seed):
    """However dense the points are: the renderer itself is asked."""
    cameras = random_cameras(seed)
    points = torch.rand(8, 3, generator=torch.Generator().manual_seed(seed)) - 0.5
    cloud = PointGrid(points, 0.2, 4, weights)
    visible = footprint(points, cloud.support_radius, cameras, 40)
    outside = (~visible).nonzero()
    if not len(outside):
        return
    view, row, column = outside.unbind(1)
    scale = torch.tensor([cameras.width / visible.shape[2], cameras.height / visible.shape[1]])
    rays = cameras.rays(
        view, (torch.stack([column, row], 1) + HALF) * scale, torch.full((len(view),), 0.5)
    )
    renderer = CompiledRenderer(cloud, (-1.2,) * 3, (1.2,) * 3, 0.05, 0.0)
    output = renderer.render(rays, torch.full((8,), 1e4), torch.zeros(8, 3))
    assert (output.transmittance == 1).all()
    assert (output.color == 0).all()


def test_reduced_images_are_means_of_blocks():
    full = make_test_scene(ball(18.0), 3, 24)
    small = downsample_images(full, 8, 6)
    blocks = full.images.double().reshape(3, 8, 3, 6, 4, 3).mean(dim=(2, 4)) / 255
    torch.testing.assert_close(small.double(), blocks, rtol=0, atol=1e-6)  # float32
    # sides that do not divide: nothing is lost, the mean stays about the same
    odd = downsample_images(full, 7, 5)
    torch.testing.assert_close(odd.mean(dim=(1, 2)), small.mean(dim=(1, 2)), rtol=0, atol=0.05)


def random_background_scene() -> NerfScene:
    views = make_test_scene(ball(18.0), 4, 24)
    return NerfScene(views.images, views.cameras, torch.rand(4, 3))


def test_a_pixel_has_its_views_ray_color_and_background():
    full = random_background_scene()
    sampler = RaySampler(full, torch.ones(4, 12, 12, dtype=torch.bool))
    rays, colors, background = sampler.rays(torch.tensor([[2, 7, 3]]), torch.tensor([0.25]))
    uv = torch.tensor([[2 * 3.5, 2 * 7.5]])  # px of the image as it was: u goes with the column
    expected = full.cameras.rays(torch.tensor([2]), uv, torch.tensor([0.25]))
    assert torch.equal(rays.directions, expected.directions)
    assert torch.equal(rays.origins, expected.origins)
    assert rays.offsets == 0.25
    mean = full.images[2, 14:16, 6:8].float().mean(dim=(0, 1)) / 255
    torch.testing.assert_close(colors[0], mean, rtol=0, atol=1e-6)
    assert torch.equal(background[0], full.background[2])


def test_only_pixels_that_are_shown_are_drawn_all_of_them_and_by_seed():
    full, visible = random_background_scene(), torch.zeros(4, 24, 24, dtype=torch.bool)
    visible[1, 3, 4:9] = visible[3, 20, 5] = True
    sampler = RaySampler(full, visible)

    def sample(seed: int):
        rays, *rest = sampler.rays(*sampler.sample_pixels(200, torch.Generator().manual_seed(seed)))
        colors, background = rest
        return torch.cat([rays.origins, rays.directions, colors, background], dim=1), rays.offsets

    first, offsets = sample(0)
    allowed = sampler.rays(visible.nonzero(), torch.zeros(6))
    allowed_rays = torch.cat([allowed[0].origins, allowed[0].directions, *allowed[1:]], dim=1)
    same = (first[:, None] == allowed_rays[None]).all(dim=2)
    assert same.any(dim=1).all()
    assert same.any(dim=0).all()  # a miss has a chance of 6 (5/6)^200 = 1e-15
    assert ((offsets >= 0) & (offsets < 1)).all()
    assert offsets.std() > 0.2  # even: 0.29
    assert torch.equal(first, sample(0)[0])
    assert not torch.equal(first, sample(1)[0])


def test_a_reading_of_several_pixels_is_their_mean_unless_they_are_not_of_one_surface():
    depth = torch.full((1, 4, 6), 2.0)
    depth[0, :2, :2] = torch.tensor([[2.0, 2.004], [2.008, 2.012]])
    depth[0, 0, 2] = 2.0 + 1.01 * DEPTH_EDGE  # an edge
    depth[0, 3, 5] = 0.0  # no reading
    expected = torch.tensor([[[2.006, 0.0, 2.0], [2.0, 2.0, 0.0]]])
    torch.testing.assert_close(downsample_depth(depth, 2, 3), expected, rtol=0, atol=1e-6)


def test_distances_are_along_the_ray_and_not_along_the_axis():
    """A wall 3 before a camera that looks at it squarely: depth 3 everywhere."""
    wall = random_background_scene()
    full = replace(wall, depth=torch.full((4, 24, 24), 3.0))
    sampler = RaySampler(full, torch.ones(4, 24, 24, dtype=torch.bool))
    pixel_indices = torch.tensor([[1, 0, 0], [2, 11, 11], [3, 23, 4]])
    rays, *_ = sampler.rays(pixel_indices, torch.zeros(3))
    distances = sampler.ray_depths(pixel_indices, rays)
    hits = (
        rays.origins
        + distances[:, None] * rays.directions
        - full.cameras.c2w[pixel_indices[:, 0], :3, 3]
    )
    along = (hits * full.cameras.c2w[pixel_indices[:, 0], :3, 2]).sum(dim=1)
    torch.testing.assert_close(along, torch.full((3,), 3.0))
    assert distances[0] > 1.05 * distances[1]
    assert (
        RaySampler(wall, sampler.visible_pixels.new_ones(4, 24, 24).bool()).ray_depths(
            pixel_indices, rays
        )
        is None
    )


def test_noise_has_its_deviation_and_none_draws_nothing():
    generator = torch.Generator().manual_seed(0)
    before, plain = generator.get_state(), torch.full((20_000, 3), 0.5)
    assert torch.equal(add_noise(plain, 0.0, generator), plain)
    assert torch.equal(generator.get_state(), before)
    noisy = add_noise(plain, 0.05, generator)
    assert noisy.std().item() == pytest.approx(0.05, rel=0.02)  # of 60 000 draws: 0.3 %
    assert noisy.mean().item() == pytest.approx(0.5, abs=1e-3)
