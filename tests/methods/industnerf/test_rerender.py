"""Pictures of a field: every pixel as the renderer has it, depth along z, in the world's unit."""

import numpy as np
import pytest
import torch

from industnerf.geometry.cameras import pixel_centers, project, unproject
from industnerf.methods.industnerf.point_levels import grid_spacing, initial_grid
from industnerf.methods.industnerf.rerender import rerender
from industnerf.methods.industnerf.scene import torch_cameras
from industnerf.rendering.compiled_renderer import CompiledRenderer
from industnerf.rendering.points import PointGrid
from tests.methods.industnerf.synthetic_scenes import CENTER, CPU, SCENE_RADIUS, orbit_cameras

SPACING = grid_spacing(16, 0)
SIDE = 40
BACKGROUNDS = torch.tensor([[1.0, 0.5, 0.0], [0.2, 0.2, 0.2], [0.0, 1.0, 0.5]])


def a_field(radius: float = 0.5, density: float = 400.0):
    """A ball of points in a color each, opaque; the other points are empty."""
    points = PointGrid(initial_grid(SPACING, CPU), 1.1 * SPACING, 8, "inverse_square")
    sigma = torch.where(points.positions.norm(dim=1) < radius, density, 0.0)
    side = 1 + SPACING
    renderer = CompiledRenderer(points, (-side,) * 3, (side,) * 3, SPACING, 0.01)
    return renderer, sigma, points.positions.clamp(-1, 1) / 2 + 0.5


def render_field(density: float = 400.0):
    cameras = torch_cameras(orbit_cameras(3, SIDE), CENTER, SCENE_RADIUS, CPU)
    renderer, sigma, rgb = a_field(density=density)
    return (
        cameras,
        rerender(cameras, BACKGROUNDS, renderer, sigma, rgb, SCENE_RADIUS),
        (renderer, sigma, rgb),
    )


def test_every_pixel_is_as_the_renderer_has_it():
    """Also those beside the footprint, which are not rendered at all."""
    torch_cams, rendering, (renderer, sigma, rgb) = render_field(
        density=8.0
    )  # half through at the rim
    cameras, uv = orbit_cameras(3, SIDE), torch.tensor(pixel_centers(SIDE, SIDE)).float()
    for view in range(3):
        views = torch.full((len(uv),), view)
        rays = torch_cams.rays(views, uv, torch.full((len(uv),), 0.5))
        output = renderer.render(rays, sigma, rgb)
        color = output.composite_over(BACKGROUNDS[views]).reshape(SIDE, SIDE, 3).numpy()
        opacity = 1 - output.transmittance.reshape(SIDE, SIDE).numpy()
        assert 0.05 < opacity.mean() < 0.5
        hits = (rays.origins + output.median_depth[:, None] * rays.directions).double().numpy()
        depth = project(hits * SCENE_RADIUS + CENTER, cameras.K[view], cameras.c2w[view])[1]
        depth[output.median_depth.numpy() < 0] = 0
        # float32 of 120 mm
        np.testing.assert_allclose(rendering.depth_mm[view].ravel(), depth, rtol=0, atol=1e-3)
        # levels are rounded to the nearest of 255
        np.testing.assert_allclose(rendering.rgb[view] / 255, color, rtol=0, atol=0.51 / 255)
        np.testing.assert_allclose(rendering.opacity[view] / 255, opacity, rtol=0, atol=0.51 / 255)


def test_depth_leads_back_to_the_surface_in_the_world():
    _, rendering, _ = render_field()
    cameras = orbit_cameras(3, SIDE)
    for view in range(3):
        depth = rendering.depth_mm[view].ravel().astype(float)
        hit = depth > 0
        uv = pixel_centers(SIDE, SIDE)[hit]
        world = unproject(uv, depth[hit], cameras.K[view], cameras.c2w[view])
        distance = np.linalg.norm(world - CENTER, axis=1) / SCENE_RADIUS
        # the outermost points are up to a cell's diagonal inside, what they color goes on for
        # a radius, and half of the light is lost half a step sooner or later
        assert (distance < 0.5 + 1.6 * SPACING).all()
        assert (distance > 0.5 - 2.3 * SPACING).all()


def test_where_half_of_the_light_passes_there_is_no_depth():
    _, rendering, _ = render_field(density=8.0)
    np.testing.assert_array_equal(rendering.depth_mm > 0, rendering.opacity >= 128)


@pytest.mark.parametrize("softer", [0.5, 20.0])
def test_no_pixel_that_either_surface_reaches_is_left_out(softer):
    """A ball of distances, of which the median is asked with another softness than the color."""
    cameras = torch_cameras(orbit_cameras(1, SIDE), CENTER, SCENE_RADIUS, CPU)
    renderer, _, rgb = a_field()
    distance = renderer.points.positions.norm(dim=1) - 0.5
    renderer.beta = 0.2 * SPACING
    renderer.median_beta = softer * renderer.beta
    rendering = rerender(cameras, BACKGROUNDS[:1], renderer, distance, rgb, SCENE_RADIUS)
    uv = torch.tensor(pixel_centers(SIDE, SIDE)).float()
    rays = cameras.rays(torch.zeros(len(uv), dtype=torch.int64), uv, torch.full((len(uv),), 0.5))
    output = renderer.render(rays, distance, rgb)
    np.testing.assert_array_equal(rendering.depth_mm.ravel() > 0, output.median_depth.numpy() > 0)
    np.testing.assert_allclose(
        rendering.opacity.ravel() / 255, 1 - output.transmittance, atol=0.51 / 255
    )


def test_an_empty_field_is_background():
    cameras = torch_cameras(orbit_cameras(3, SIDE), CENTER, SCENE_RADIUS, CPU)
    renderer, sigma, rgb = a_field()
    rendering = rerender(cameras, BACKGROUNDS, renderer, torch.zeros_like(sigma), rgb, SCENE_RADIUS)
    assert not rendering.depth_mm.any()
    assert not rendering.opacity.any()
    levels = (BACKGROUNDS * 255).round().numpy().astype(np.uint8)
    np.testing.assert_array_equal(
        rendering.rgb, np.broadcast_to(levels[:, None, None], (3, 40, 40, 3))
    )
