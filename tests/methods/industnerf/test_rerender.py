"""Pictures of a field: every pixel as the renderer has it, depth along z, in the world's unit."""

import numpy as np
import pytest
import torch

from industnerf.geometry.cameras import pixel_centres, project, unproject
from industnerf.methods.industnerf.levels import grid, spacing_of
from industnerf.methods.industnerf.rerender import rerender
from industnerf.methods.industnerf.scene import eyes
from industnerf.rendering.points import Points
from industnerf.rendering.render import Renderer
from tests.methods.industnerf.scenes import CENTRE, CPU, REACH, around

SPACING = spacing_of(16, 0)
SIDE = 40
BEHIND = torch.tensor([[1.0, 0.5, 0.0], [0.2, 0.2, 0.2], [0.0, 1.0, 0.5]])


def a_field(radius: float = 0.5, density: float = 400.0):
    """A ball of points in a colour each, opaque; the other points are empty."""
    points = Points(grid(SPACING, CPU), 1.1 * SPACING, 8, "inverse_square")
    sigma = torch.where(points.positions.norm(dim=1) < radius, density, 0.0)
    side = 1 + SPACING
    renderer = Renderer(points, (-side,) * 3, (side,) * 3, SPACING, 0.01)
    return renderer, sigma, points.positions.clamp(-1, 1) / 2 + 0.5


def pictures(density: float = 400.0):
    looking = eyes(around(3, SIDE), CENTRE, REACH, CPU)
    renderer, sigma, rgb = a_field(density=density)
    return looking, rerender(looking, BEHIND, renderer, sigma, rgb, REACH), (renderer, sigma, rgb)


def test_every_pixel_is_as_the_renderer_has_it():
    """Also those beside the footprint, which are not rendered at all."""
    looking, taken, (renderer, sigma, rgb) = pictures(density=8.0)  # half through at the rim
    cameras, uv = around(3, SIDE), torch.tensor(pixel_centres(SIDE, SIDE)).float()
    for view in range(3):
        views = torch.full((len(uv),), view)
        rays = looking.rays(views, uv, torch.full((len(uv),), 0.5))
        seen = renderer.look(rays, sigma, rgb)
        colour = seen.over(BEHIND[views]).reshape(SIDE, SIDE, 3).numpy()
        opacity = 1 - seen.through.reshape(SIDE, SIDE).numpy()
        assert 0.05 < opacity.mean() < 0.5
        met = (rays.origins + seen.median[:, None] * rays.directions).double().numpy()
        depth = project(met * REACH + CENTRE, cameras.K[view], cameras.c2w[view])[1]
        depth[seen.median.numpy() < 0] = 0
        # float32 of 120 mm
        np.testing.assert_allclose(taken.depth_mm[view].ravel(), depth, rtol=0, atol=1e-3)
        # levels are rounded to the nearest of 255
        np.testing.assert_allclose(taken.rgb[view] / 255, colour, rtol=0, atol=0.51 / 255)
        np.testing.assert_allclose(taken.opacity[view] / 255, opacity, rtol=0, atol=0.51 / 255)


def test_depth_leads_back_to_the_surface_in_the_world():
    _, taken, _ = pictures()
    cameras = around(3, SIDE)
    for view in range(3):
        depth = taken.depth_mm[view].ravel().astype(float)
        hit = depth > 0
        uv = pixel_centres(SIDE, SIDE)[hit]
        world = unproject(uv, depth[hit], cameras.K[view], cameras.c2w[view])
        out = np.linalg.norm(world - CENTRE, axis=1) / REACH
        # the outermost points are up to a cell's diagonal inside, what they colour goes on for
        # a radius, and half of the light is lost half a step sooner or later
        assert (out < 0.5 + 1.6 * SPACING).all()
        assert (out > 0.5 - 2.3 * SPACING).all()


def test_where_half_of_the_light_passes_there_is_no_depth():
    _, taken, _ = pictures(density=8.0)
    np.testing.assert_array_equal(taken.depth_mm > 0, taken.opacity >= 128)


@pytest.mark.parametrize("softer", [0.5, 20.0])
def test_no_pixel_that_either_surface_reaches_is_left_out(softer):
    """A ball of distances, of which the median is asked with another softness than the colour."""
    looking = eyes(around(1, SIDE), CENTRE, REACH, CPU)
    renderer, _, rgb = a_field()
    distance = renderer.points.positions.norm(dim=1) - 0.5
    renderer.beta = 0.2 * SPACING
    renderer.median_beta = softer * renderer.beta
    taken = rerender(looking, BEHIND[:1], renderer, distance, rgb, REACH)
    uv = torch.tensor(pixel_centres(SIDE, SIDE)).float()
    rays = looking.rays(torch.zeros(len(uv), dtype=torch.int64), uv, torch.full((len(uv),), 0.5))
    seen = renderer.look(rays, distance, rgb)
    np.testing.assert_array_equal(taken.depth_mm.ravel() > 0, seen.median.numpy() > 0)
    np.testing.assert_allclose(taken.opacity.ravel() / 255, 1 - seen.through, atol=0.51 / 255)


def test_an_empty_field_is_background():
    looking = eyes(around(3, SIDE), CENTRE, REACH, CPU)
    renderer, sigma, rgb = a_field()
    taken = rerender(looking, BEHIND, renderer, torch.zeros_like(sigma), rgb, REACH)
    assert not taken.depth_mm.any()
    assert not taken.opacity.any()
    levels = (BEHIND * 255).round().numpy().astype(np.uint8)
    np.testing.assert_array_equal(taken.rgb, np.broadcast_to(levels[:, None, None], (3, 40, 40, 3)))
