"""What the views say, against the renderer's slow twin, known solids, and loops."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.methods.industnerf.confidence import (
    ObservedSurface,
    color_contrast,
    compute_view_confidence,
    concatenate,
    voxel_downsample,
    voxel_ids,
)
from industnerf.methods.industnerf.point_levels import grid_spacing, initial_grid
from industnerf.methods.industnerf.ray_sampler import RaySampler, footprint
from industnerf.methods.industnerf.scene import NerfScene
from industnerf.rendering.compiled_renderer import CompiledRenderer
from industnerf.rendering.confidence import color_confidence, color_scale
from industnerf.rendering.points import PointGrid
from industnerf.rendering.torch_renderer import confidence_reference, render_reference
from tests.methods.industnerf.synthetic_scenes import (
    CPU,
    SCENE_RADIUS,
    ball,
    make_test_scene,
    settings,
)

VIEWS, SIDE = 3, 14
RENDER_OPTIONS = {
    "step": 0.1,
    "radius": 0.35,
    "k": 4,
    "weights": "inverse_square",
    "early_stop_transmittance": 0.01,
}
BOX = torch.tensor([-1.2, -1.2, -1.2]), torch.tensor([1.2, 1.2, 1.2])


def cloud(seed: int) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    generator = torch.Generator().manual_seed(seed)
    points = torch.rand(60, 3, generator=generator) * 1.4 - 0.7
    sigma = 4 * torch.rand(60, generator=generator) * (torch.rand(60, generator=generator) < 0.7)
    return points, sigma, torch.rand(60, 3, generator=generator)


def make_renderer(points: torch.Tensor) -> CompiledRenderer:
    cells = PointGrid(
        points, RENDER_OPTIONS["radius"], RENDER_OPTIONS["k"], RENDER_OPTIONS["weights"]
    )
    lo, hi = (tuple(corner.tolist()) for corner in BOX)
    return CompiledRenderer(
        cells, lo, hi, RENDER_OPTIONS["step"], RENDER_OPTIONS["early_stop_transmittance"]
    )


def reference_confidence(
    views: NerfScene, sampler: RaySampler, points, sigma, rgb, readings
) -> torch.Tensor:
    """(13) by view and point, from the readable renderer; confidences in a view are at most 1."""
    scale = color_scale(readings.color_scale, color_contrast(sampler))
    rows = []
    for view in range(len(views)):
        pixels = sampler.visible_pixels[sampler.visible_pixels[:, 0] == view]
        rays, target, background = sampler.rays(pixels, torch.full((len(pixels),), 0.5))
        render_inputs = (rays.origins, rays.directions, rays.offsets, *BOX, points, sigma)
        pixel = render_reference(*render_inputs, rgb, background, **RENDER_OPTIONS).rgb
        pixel_confidence = color_confidence(target, pixel, scale)
        choice = {
            "transmittance": readings.transmittance,
            "opacity": readings.opacity,
            "samples": readings.sample_reduction,
        }
        rows.append(
            confidence_reference(*render_inputs, pixel_confidence, **RENDER_OPTIONS, **choice)
        )
    return torch.stack(rows).clamp(max=1)


@pytest.mark.parametrize("transmittance", ["shared", "own"])
@pytest.mark.parametrize("opacity", ["with", "without"])
@pytest.mark.parametrize("samples", ["max", "sum"])
@pytest.mark.parametrize("scale", ["max", "contrast"])
def test_confidence_is_what_the_readable_renderer_says(transmittance, opacity, samples, scale):
    readings = settings(
        readings={
            "transmittance": transmittance,
            "opacity": opacity,
            "sample_reduction": samples,
            "color_scale": scale,
        }
    ).readings
    views, (points, sigma, rgb) = make_test_scene(ball(18.0), VIEWS, SIDE), cloud(3)
    renderer = make_renderer(points)
    points, sigma, rgb = (values[renderer.points.order] for values in (points, sigma, rgb))
    sampler = RaySampler(views, torch.ones(VIEWS, SIDE, SIDE, dtype=torch.bool))
    view_confidence = compute_view_confidence(views, sampler, renderer, sigma, rgb, readings)
    expected = reference_confidence(views, sampler, points, sigma, rgb, readings)
    best = expected.amax(dim=0)
    # kernels are compiled with fast exponentials: 1e-5 of sums of up to 20 samples
    torch.testing.assert_close(view_confidence.confidence, best, rtol=1e-3, atol=1e-4)
    runner_up = expected.sort(dim=0).values[-2]
    is_unambiguous = best - runner_up > 1e-3
    assert is_unambiguous.any() or samples == "sum"  # sums without opacity are all 1
    assert torch.equal(view_confidence.view[is_unambiguous], expected.argmax(dim=0)[is_unambiguous])
    assert (view_confidence.view[best == 0] == -1).all()
    assert ((view_confidence.view >= -1) & (view_confidence.view < VIEWS)).all()


def solid_ball(grid_res: int, radius: float) -> tuple[CompiledRenderer, torch.Tensor, torch.Tensor]:
    """Opaque points of the grid, in the colors of the photographed ball, and empty ones."""
    spacing = grid_spacing(grid_res, 0)
    side = 1 + spacing
    points = PointGrid(initial_grid(spacing, CPU), 1.1 * spacing, 8, "inverse_square")
    sigma = torch.where(points.positions.norm(dim=1) < radius, 50 / spacing, 0.0)
    rgb = 0.45 + 0.35 * torch.sin(points.positions * SCENE_RADIUS / 5)
    return CompiledRenderer(points, (-side,) * 3, (side,) * 3, spacing, 0.01), sigma, rgb


@pytest.fixture(scope="module")
def ball_confidence():
    """An opaque ball of 0.6 that all 6 views agree with, and what they say of it."""
    views, (renderer, sigma, rgb) = make_test_scene(ball(18.0), 6, 48), solid_ball(24, 0.6)
    visible = footprint(
        renderer.points.positions[sigma > 0], renderer.points.support_radius, views.cameras, 48
    )
    sampler = RaySampler(views, visible)
    view_confidence = compute_view_confidence(
        views, sampler, renderer, sigma, rgb, settings().readings
    )
    return views, renderer.points, view_confidence


def test_surface_points_of_an_opaque_ball_lie_on_it(ball_confidence):
    _, points, view_confidence = ball_confidence
    distance = view_confidence.surface.points.norm(dim=1)
    # The ball ends with its last points, up to a cell's diagonal short of 0.6, and reaches as
    # far beyond them as neighbors count; half of the light is gone within a step of there.
    spacing = points.support_radius / 1.1
    assert (distance < 0.6 + points.support_radius + spacing / 2).all()
    assert (distance > 0.6 - (3**0.5 + 0.5) * spacing).all()
    assert distance.mean() == pytest.approx(0.6, abs=spacing)


def test_the_views_are_sure_of_the_front_and_know_nothing_of_the_inside(ball_confidence):
    _, points, view_confidence = ball_confidence
    distance = points.positions.norm(dim=1)
    spacing = points.support_radius / 1.1
    shell = (distance < 0.6) & (distance > 0.6 - 0.5 * spacing)
    assert (view_confidence.confidence[shell] > 0.5).float().mean() > 0.9
    assert (view_confidence.confidence[distance < 0.6 - 4 * spacing] < 0.01).all()
    assert (view_confidence.confidence >= 0).all()
    assert (view_confidence.confidence <= 1).all()


def test_points_are_told_of_by_a_view_that_they_face(ball_confidence):
    views, points, view_confidence = ball_confidence
    is_confident = (view_confidence.confidence > 0.5) & (points.positions.norm(dim=1) > 0.4)
    centers = views.cameras.c2w[view_confidence.view[is_confident], :3, 3]
    confident_points = points.positions[is_confident]
    # Before the horizon, n . eye > r.  A ray that grazes the ball passes it up to a neighbor's
    # radius away, and may first meet a point behind the horizon: that is rare.
    facing = (confident_points * centers).sum(dim=1) / confident_points.norm(dim=1) > 0.6
    assert facing.float().mean() > 0.9


def test_surface_points_have_the_pixels_colors_and_views(ball_confidence):
    _, _, view_confidence = ball_confidence
    surface = view_confidence.surface
    assert set(surface.view.tolist()) == set(range(6))
    is_confident = surface.confidence > 0.9
    assert is_confident.float().mean() > 0.5
    expected = 0.45 + 0.35 * torch.sin(surface.points * SCENE_RADIUS / 5)
    # a pixel of 2 mm and a surface that is off by a spacing of 2.5 mm, where the texture climbs
    # by 0.07 a mm at most
    assert (surface.rgb - expected)[is_confident].abs().mean() < 0.07


def test_a_surface_of_the_wrong_color_is_less_sure():
    """(12) falls by the distance of the colors over L, and (13) with it."""
    views, (renderer, sigma, rgb) = make_test_scene(ball(18.0), 2, 24), solid_ball(16, 0.6)
    sampler = RaySampler(views, torch.ones(2, 24, 24, dtype=torch.bool))
    readings = settings(readings={"color_scale": "unit"}).readings
    right, wrong = (
        compute_view_confidence(views, sampler, renderer, sigma, rgb + off, readings).surface
        for off in (0.0, -0.2)
    )
    assert torch.equal(right.points, wrong.points)
    is_confident = right.confidence > 0.95
    assert is_confident.any()
    # from a rendered color that is off by up to 0.05, one that is off by 0.2 sqrt(3) more
    decrease = (right.confidence - wrong.confidence)[is_confident]
    np.testing.assert_allclose(decrease, 0.2 * 3**0.5, atol=2 * 0.05)


def test_contrast_is_the_diagonal_of_the_box_of_colors():
    views = make_test_scene(ball(18.0), 1, 8)
    images = torch.full_like(views.images, 100)
    images[0, 2, 3], images[0, 4, 4], images[0, 0, 0] = (
        torch.tensor(c, dtype=torch.uint8) for c in ([10, 100, 100], [100, 200, 130], [255, 0, 0])
    )
    mask = torch.ones(1, 8, 8, dtype=torch.bool)
    mask[0, 0, 0] = False  # what is not shown does not count
    sampler = RaySampler(NerfScene(images, views.cameras, views.background), mask)
    assert color_contrast(sampler) == pytest.approx((90**2 + 100**2 + 30**2) ** 0.5 / 255, rel=1e-6)
    assert color_contrast(RaySampler(views, torch.zeros_like(mask))) == 1
    plain = NerfScene(torch.full_like(images, 100), views.cameras, views.background)
    assert color_contrast(RaySampler(plain, mask)) == 1 / 255  # (12) divides by it


def a_surface(seed: int, count: int) -> ObservedSurface:
    generator = torch.Generator().manual_seed(seed)
    points, rgb = (torch.rand(count, 3, generator=generator) * 2 - 1 for _ in range(2))
    return ObservedSurface(points, rgb, torch.rand(count, generator=generator), torch.arange(count))


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.3, 0.7, 5.0]))
def test_one_point_of_every_cell_is_left_with_the_surest_color(seed, spacing):
    surface = a_surface(seed, 80)
    downsampled = voxel_downsample(surface, spacing)
    cells: dict[tuple, list[int]] = {}
    for i, point in enumerate(surface.points):
        cells.setdefault(tuple((point / spacing).floor().int().tolist()), []).append(i)
    assert len(downsampled.points) == len(cells)
    most_confident = [
        max(members, key=lambda i: surface.confidence[i]) for members in cells.values()
    ]
    assert set(downsampled.view.tolist()) == set(most_confident)
    for members, best in zip(cells.values(), most_confident, strict=True):
        row = downsampled.view == best
        mean = surface.points[members].mean(dim=0)
        torch.testing.assert_close(downsampled.points[row][0], mean, rtol=0, atol=1e-6)
        assert torch.equal(downsampled.rgb[row][0], surface.rgb[best])
        assert downsampled.confidence[row] == surface.confidence[best]


def test_nothing_thins_to_nothing():
    assert not len(voxel_downsample(a_surface(0, 0), 0.1).points)


def test_joined_surfaces_follow_one_another():
    a, b = a_surface(0, 3), a_surface(1, 2)
    both = concatenate([a, b])
    for name, values in vars(both).items():
        assert torch.equal(values, torch.cat([getattr(a, name), getattr(b, name)]))


@pytest.mark.parametrize("count", [0, 1, 500])
def test_cells_have_numbers_in_the_order_of_their_rows(count: int):
    points = torch.randn(count, 3, generator=torch.Generator().manual_seed(count))
    points[: count // 3] *= 0.1  # several in a cell
    rows = (points / 0.25).floor().long()
    _, expected = torch.unique(rows, dim=0, return_inverse=True) if count else (None, rows[:, 0])
    _, actual = torch.unique(voxel_ids(points, 0.25), return_inverse=True)
    assert torch.equal(actual, expected)
