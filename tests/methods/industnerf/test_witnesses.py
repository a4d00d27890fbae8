"""What the views say, against the renderer's slow twin, known solids, and loops."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.methods.industnerf import witnesses  # a class called Test... would be collected
from industnerf.methods.industnerf.levels import grid, spacing_of
from industnerf.methods.industnerf.pixels import Pixels, footprint
from industnerf.methods.industnerf.scene import Scene
from industnerf.methods.industnerf.witnesses import (
    Surface,
    cell_numbers,
    contrast_of,
    joined,
    thinned,
)
from industnerf.rendering.confidence import colour_confidence, colour_scale
from industnerf.rendering.points import Points
from industnerf.rendering.render import Renderer
from industnerf.rendering.twin import confidence_twin, render_twin
from tests.methods.industnerf.scenes import CPU, REACH, ball, scene, settings

VIEWS, SIDE = 3, 14
HOW = {"step": 0.1, "radius": 0.35, "k": 4, "weights": "inverse_square", "stop": 0.01}
BOX = torch.tensor([-1.2, -1.2, -1.2]), torch.tensor([1.2, 1.2, 1.2])


def cloud(seed: int) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    generator = torch.Generator().manual_seed(seed)
    points = torch.rand(60, 3, generator=generator) * 1.4 - 0.7
    sigma = 4 * torch.rand(60, generator=generator) * (torch.rand(60, generator=generator) < 0.7)
    return points, sigma, torch.rand(60, 3, generator=generator)


def renderer_of(points: torch.Tensor) -> Renderer:
    cells = Points(points, HOW["radius"], HOW["k"], HOW["weights"])
    lo, hi = (tuple(corner.tolist()) for corner in BOX)
    return Renderer(cells, lo, hi, HOW["step"], HOW["stop"])


def twin(seen: Scene, pixels: Pixels, points, sigma, rgb, readings) -> torch.Tensor:
    """(13) by view and point, from the readable renderer; confidences in a view are at most 1."""
    scale = colour_scale(readings.scale, contrast_of(pixels))
    rows = []
    for view in range(len(seen)):
        shown = pixels.shown[pixels.shown[:, 0] == view]
        rays, target, background = pixels.rays(shown, torch.full((len(shown),), 0.5))
        looked = (rays.origins, rays.directions, rays.offsets, *BOX, points, sigma)
        pixel = render_twin(*looked, rgb, background, **HOW).rgb
        agreement = colour_confidence(target, pixel, scale)
        choice = {name: getattr(readings, name) for name in ("transmittance", "opacity", "samples")}
        rows.append(confidence_twin(*looked, agreement, **HOW, **choice))
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
            "samples": samples,
            "scale": scale,
        }
    ).readings
    seen, (points, sigma, rgb) = scene(ball(18.0), VIEWS, SIDE), cloud(3)
    renderer = renderer_of(points)
    points, sigma, rgb = (values[renderer.points.order] for values in (points, sigma, rgb))
    pixels = Pixels(seen, torch.ones(VIEWS, SIDE, SIDE, dtype=torch.bool))
    told = witnesses.testimony(seen, pixels, renderer, sigma, rgb, readings)
    truth = twin(seen, pixels, points, sigma, rgb, readings)
    best = truth.amax(dim=0)
    # kernels are compiled with fast exponentials: 1e-5 of sums of up to 20 samples
    torch.testing.assert_close(told.confidence, best, rtol=1e-3, atol=1e-4)
    runner_up = truth.sort(dim=0).values[-2]
    clear = best - runner_up > 1e-3
    assert clear.any() or samples == "sum"  # sums without opacity are all 1
    assert torch.equal(told.view[clear], truth.argmax(dim=0)[clear])
    assert (told.view[best == 0] == -1).all()
    assert ((told.view >= -1) & (told.view < VIEWS)).all()


def solid_ball(grid_res: int, radius: float) -> tuple[Renderer, torch.Tensor, torch.Tensor]:
    """Opaque points of the grid, in the colours of the photographed ball, and empty ones."""
    spacing = spacing_of(grid_res, 0)
    side = 1 + spacing
    points = Points(grid(spacing, CPU), 1.1 * spacing, 8, "inverse_square")
    sigma = torch.where(points.positions.norm(dim=1) < radius, 50 / spacing, 0.0)
    rgb = 0.45 + 0.35 * torch.sin(points.positions * REACH / 5)
    return Renderer(points, (-side,) * 3, (side,) * 3, spacing, 0.01), sigma, rgb


@pytest.fixture(scope="module")
def of_the_ball():
    """An opaque ball of 0.6 that all 6 views agree with, and what they say of it."""
    seen, (renderer, sigma, rgb) = scene(ball(18.0), 6, 48), solid_ball(24, 0.6)
    shown = footprint(renderer.points.positions[sigma > 0], renderer.points.radius, seen.eyes, 48)
    pixels = Pixels(seen, shown)
    told = witnesses.testimony(seen, pixels, renderer, sigma, rgb, settings().readings)
    return seen, renderer.points, told


def test_surface_points_of_an_opaque_ball_lie_on_it(of_the_ball):
    _, points, told = of_the_ball
    out = told.surface.points.norm(dim=1)
    # The ball ends with its last points, up to a cell's diagonal short of 0.6, and reaches as
    # far beyond them as neighbours count; half of the light is gone within a step of there.
    spacing = points.radius / 1.1
    assert (out < 0.6 + points.radius + spacing / 2).all()
    assert (out > 0.6 - (3**0.5 + 0.5) * spacing).all()
    assert out.mean() == pytest.approx(0.6, abs=spacing)


def test_the_views_are_sure_of_the_front_and_know_nothing_of_the_inside(of_the_ball):
    _, points, told = of_the_ball
    out = points.positions.norm(dim=1)
    spacing = points.radius / 1.1
    shell = (out < 0.6) & (out > 0.6 - 0.5 * spacing)
    assert (told.confidence[shell] > 0.5).float().mean() > 0.9
    assert (told.confidence[out < 0.6 - 4 * spacing] < 0.01).all()
    assert (told.confidence >= 0).all()
    assert (told.confidence <= 1).all()


def test_points_are_told_of_by_a_view_that_they_face(of_the_ball):
    seen, points, told = of_the_ball
    sure = (told.confidence > 0.5) & (points.positions.norm(dim=1) > 0.4)
    eyes = seen.eyes.c2w[told.view[sure], :3, 3]
    at = points.positions[sure]
    # Before the horizon, n . eye > r.  A ray that grazes the ball passes it up to a neighbour's
    # radius away, and may first meet a point behind the horizon: that is rare.
    facing = (at * eyes).sum(dim=1) / at.norm(dim=1) > 0.6
    assert facing.float().mean() > 0.9


def test_surface_points_have_the_pixels_colours_and_views(of_the_ball):
    _, _, told = of_the_ball
    surface = told.surface
    assert set(surface.view.tolist()) == set(range(6))
    sure = surface.confidence > 0.9
    assert sure.float().mean() > 0.5
    truth = 0.45 + 0.35 * torch.sin(surface.points * REACH / 5)
    # a pixel of 2 mm and a surface that is off by a spacing of 2.5 mm, where the texture climbs
    # by 0.07 a mm at most
    assert (surface.rgb - truth)[sure].abs().mean() < 0.07


def test_a_surface_of_the_wrong_colour_is_less_sure():
    """(12) falls by the distance of the colours over L, and (13) with it."""
    seen, (renderer, sigma, rgb) = scene(ball(18.0), 2, 24), solid_ball(16, 0.6)
    pixels = Pixels(seen, torch.ones(2, 24, 24, dtype=torch.bool))
    readings = settings(readings={"scale": "unit"}).readings
    right, wrong = (
        witnesses.testimony(seen, pixels, renderer, sigma, rgb + off, readings).surface
        for off in (0.0, -0.2)
    )
    assert torch.equal(right.points, wrong.points)
    sure = right.confidence > 0.95
    assert sure.any()
    # from a rendered colour that is off by up to 0.05, one that is off by 0.2 sqrt(3) more
    fallen = (right.confidence - wrong.confidence)[sure]
    np.testing.assert_allclose(fallen, 0.2 * 3**0.5, atol=2 * 0.05)


def test_contrast_is_the_diagonal_of_the_box_of_colours():
    seen = scene(ball(18.0), 1, 8)
    images = torch.full_like(seen.images, 100)
    images[0, 2, 3], images[0, 4, 4], images[0, 0, 0] = (
        torch.tensor(c, dtype=torch.uint8) for c in ([10, 100, 100], [100, 200, 130], [255, 0, 0])
    )
    shown = torch.ones(1, 8, 8, dtype=torch.bool)
    shown[0, 0, 0] = False  # what is not shown does not count
    pixels = Pixels(Scene(images, seen.eyes, seen.background), shown)
    assert contrast_of(pixels) == pytest.approx((90**2 + 100**2 + 30**2) ** 0.5 / 255, rel=1e-6)
    assert contrast_of(Pixels(seen, torch.zeros_like(shown))) == 1
    plain = Scene(torch.full_like(images, 100), seen.eyes, seen.background)
    assert contrast_of(Pixels(plain, shown)) == 1 / 255  # (12) divides by it


def a_surface(seed: int, count: int) -> Surface:
    generator = torch.Generator().manual_seed(seed)
    points, rgb = (torch.rand(count, 3, generator=generator) * 2 - 1 for _ in range(2))
    return Surface(points, rgb, torch.rand(count, generator=generator), torch.arange(count))


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.3, 0.7, 5.0]))
def test_one_point_of_every_cell_is_left_with_the_surest_colour(seed, spacing):
    surface = a_surface(seed, 80)
    thin = thinned(surface, spacing)
    cells: dict[tuple, list[int]] = {}
    for i, point in enumerate(surface.points):
        cells.setdefault(tuple((point / spacing).floor().int().tolist()), []).append(i)
    assert len(thin.points) == len(cells)
    surest = [max(held, key=lambda i: surface.confidence[i]) for held in cells.values()]
    assert set(thin.view.tolist()) == set(surest)
    for held, best in zip(cells.values(), surest, strict=True):
        row = thin.view == best
        mean = surface.points[held].mean(dim=0)
        torch.testing.assert_close(thin.points[row][0], mean, rtol=0, atol=1e-6)
        assert torch.equal(thin.rgb[row][0], surface.rgb[best])
        assert thin.confidence[row] == surface.confidence[best]


def test_nothing_thins_to_nothing():
    assert not len(thinned(a_surface(0, 0), 0.1).points)


def test_joined_surfaces_follow_one_another():
    a, b = a_surface(0, 3), a_surface(1, 2)
    both = joined([a, b])
    for name, values in vars(both).items():
        assert torch.equal(values, torch.cat([getattr(a, name), getattr(b, name)]))


@pytest.mark.parametrize("count", [0, 1, 500])
def test_cells_have_numbers_in_the_order_of_their_rows(count: int):
    points = torch.randn(count, 3, generator=torch.Generator().manual_seed(count))
    points[: count // 3] *= 0.1  # several in a cell
    rows = (points / 0.25).floor().long()
    _, wanted = torch.unique(rows, dim=0, return_inverse=True) if count else (None, rows[:, 0])
    _, found = torch.unique(cell_numbers(points, 0.25), return_inverse=True)
    assert torch.equal(found, wanted)
