"""The compiled kernels against the torch twin, on every scene.

float32 marches of a few hundred steps: 1e-4 is a hundred roundings, gradients add some thousand
terms and are compared by the largest; so that small ones count too, nine in ten, those whose terms
do not cancel, are to be right to 1e-3 by themselves.
"""

import math
from dataclasses import replace

import pytest
import torch

from industnerf.errors import ReconstructionFailed
from industnerf.rendering.compiled_renderer import CompiledRenderer
from industnerf.rendering.points import PointGrid
from industnerf.rendering.render import Rays, RenderOutput
from industnerf.rendering.sdf_density import density
from industnerf.rendering.torch_renderer import confidence_reference, render_reference
from tests.rendering.scene_renderers import scene_renderer, to_renderer_order, to_scene_order
from tests.rendering.scenes import SCENES, RenderScene

DEFAULT = {"transmittance": "shared", "opacity": "with", "samples": "max"}


@pytest.fixture(params=SCENES)
def scene(request: pytest.FixtureRequest) -> RenderScene:
    return SCENES[request.param]


def test_pixels_are_the_twins(scene):
    renderer, rays = scene_renderer(scene)
    rendered = renderer.render(
        rays, to_renderer_order(renderer, scene.sigma), to_renderer_order(renderer, scene.rgb)
    )
    reference = render_reference(*scene.render_inputs, **scene.settings)
    pixels = rendered.composite_over(scene.background.float())
    torch.testing.assert_close(pixels.double(), reference.rgb, rtol=1e-4, atol=1e-5)
    torch.testing.assert_close(
        1 - rendered.transmittance.double(), reference.opacity, rtol=1e-4, atol=1e-5
    )
    solid = reference.opacity > 0.01  # below, 1 - T cancels in float32
    torch.testing.assert_close(
        rendered.depth[solid].double(), reference.depth[solid], rtol=1e-3, atol=1e-4
    )


def test_a_neighbor_that_weighs_nothing_is_none():
    """Rays graze a ball of the radius about one point: a tapered weight of 0 is not divided by."""
    radius, n = 0.03, 5000
    points = PointGrid(torch.zeros(1, 3), radius, 4, "modified_shepard")
    rotation = torch.linspace(0, 2 * math.pi, n, dtype=torch.float64)
    edge = torch.stack(
        [torch.full_like(rotation, -2.0), radius * rotation.cos(), radius * rotation.sin()], 1
    )
    rays = Rays(edge.float(), torch.tensor([[1.0, 0.0, 0.0]]).expand(n, 3), torch.full((n,), 0.5))
    sigma = torch.ones(1, requires_grad=True)
    rendered = CompiledRenderer(points, (-1.0,) * 3, (1.0,) * 3, 2.0, 1e-3).render(
        rays, sigma, torch.ones(1, 3)
    )
    rendered.transmittance.sum().backward()
    assert all(
        result.isfinite().all() for result in (rendered.color, rendered.transmittance, sigma.grad)
    )


def test_gradients_are_the_twins(scene):
    renderer, rays = scene_renderer(scene)
    sigma, rgb = (to_renderer_order(renderer, x).requires_grad_() for x in (scene.sigma, scene.rgb))
    back_color = scene.background.float().requires_grad_()
    pull = torch.linspace(-1, 1, 3 * len(rays)).reshape(-1, 3)
    rendered = renderer.render(rays, sigma, rgb)
    solid = rendered.transmittance < 0.99  # above, 1 - T cancels in float32
    depths = (rendered.depth * pull[:, 1])[solid].sum()
    (
        (rendered.composite_over(back_color) * pull).sum()
        + rendered.transmittance @ pull[:, 0]
        + depths
    ).backward()

    leaves = [x.clone().requires_grad_() for x in scene.render_inputs[6:9]]
    reference = render_reference(*scene.render_inputs[:6], *leaves, **scene.settings)
    pull = pull.double()
    depths = (reference.depth * pull[:, 1])[solid].sum()
    ((reference.rgb * pull).sum() + (1 - reference.opacity) @ pull[:, 0] + depths).backward()
    ours = (
        to_scene_order(renderer, sigma.grad),
        to_scene_order(renderer, rgb.grad),
        back_color.grad.double(),
    )
    for mine, leaf in zip(ours, leaves, strict=True):
        largest = leaf.grad.abs().max().item()
        torch.testing.assert_close(mine, leaf.grad, rtol=1e-3, atol=1e-3 * largest)
        is_off = (mine - leaf.grad).abs() > 1e-3 * leaf.grad.abs()
        assert is_off.sum() <= 0.1 * leaf.grad.count_nonzero()


@pytest.mark.parametrize("samples", ["max", "sum"])
@pytest.mark.parametrize("transmittance", ["shared", "own"])
@pytest.mark.parametrize("opacity", ["without", "with"])
def test_confidence_is_the_twins(scene, transmittance, opacity, samples):
    readings = {"transmittance": transmittance, "opacity": opacity, "samples": samples}
    renderer, rays = scene_renderer(scene)
    sigma = to_renderer_order(renderer, scene.sigma)
    renderer.render(rays, sigma, to_renderer_order(renderer, scene.rgb))
    ours = torch.zeros_like(sigma)
    renderer.accumulate_confidence(sigma, scene.agreement.float(), ours, **readings)
    reference = confidence_reference(*scene.confidence_inputs, **readings, **scene.settings)
    torch.testing.assert_close(to_scene_order(renderer, ours), reference, rtol=1e-3, atol=1e-5)


def test_skipping_empty_points_changes_nothing(scene):
    renderer, rays = scene_renderer(scene)
    sigma, rgb = to_renderer_order(renderer, scene.sigma), to_renderer_order(renderer, scene.rgb)
    before = renderer.render(rays, sigma, rgb)
    renderer.points.update_occupancy(density(sigma, renderer.beta) > 0)
    after = renderer.render(rays, sigma, rgb)
    # samples are the same ones; only their places t = t_in + q step are reached by other sums
    torch.testing.assert_close(after.color, before.color, rtol=1e-5, atol=1e-6)
    torch.testing.assert_close(after.transmittance, before.transmittance, rtol=1e-5, atol=1e-6)


def test_nothing_filled_leaves_the_background(scene):
    renderer, rays = scene_renderer(scene)
    renderer.points.update_occupancy(torch.zeros(len(renderer.points), dtype=torch.bool))
    rendered = renderer.render(
        rays, to_renderer_order(renderer, scene.sigma), to_renderer_order(renderer, scene.rgb)
    )
    assert (rendered.transmittance == 1).all()
    assert (rendered.median_depth == -1).all()


def test_half_of_the_light_is_left_at_the_median():
    """A slab of density 2 from x = 0: T = exp(-2 x) is 1/2 at x = ln 2 / 2."""
    grid = torch.linspace(0.01, 0.99, 50)
    points = torch.stack(torch.meshgrid(grid, grid, grid, indexing="ij"), -1).reshape(-1, 3)
    renderer = CompiledRenderer(
        PointGrid(points, 0.03, 8, "inverse"), (0.0,) * 3, (1.0,) * 3, 0.01, 0.0
    )
    rays = Rays(
        torch.tensor([[-1.0, 0.5, 0.5]]), torch.tensor([[1.0, 0.0, 0.0]]), torch.tensor([0.5])
    )
    rendered = renderer.render(rays, torch.full((len(points),), 2.0), torch.ones(len(points), 3))
    assert rendered.median_depth.item() - 1 == pytest.approx(0.5 * math.log(2), abs=1e-3)


@pytest.mark.parametrize("harder", [0.1, 0.6, 3.0])
def test_a_median_of_another_softness_is_that_of_a_second_look(harder):
    """Bit for bit; neither the pixel nor the way back hears of it, though they end before it."""
    scene = SCENES["sdf"].with_settings(early_stop_transmittance=0.3)
    renderer, rays = scene_renderer(scene)
    values, rgb = to_renderer_order(renderer, scene.sigma), to_renderer_order(renderer, scene.rgb)

    def look(beta: float, median_beta: float) -> tuple[RenderOutput, torch.Tensor]:
        renderer.beta = beta
        renderer.median_beta = median_beta
        leaf = values.clone().requires_grad_()
        rendered = renderer.render(rays, leaf, rgb)
        (rendered.color.sum() + rendered.depth.sum()).backward()
        return rendered, leaf.grad

    smooth, other = renderer.beta, harder * renderer.beta
    (once, slope), (own, own_slope), (second, _) = (
        look(*betas) for betas in ((smooth, other), (smooth, smooth), (other, other))
    )
    for name in ("color", "transmittance", "depth"):
        assert torch.equal(getattr(once, name), getattr(own, name))
    assert torch.equal(slope, own_slope)
    expected = torch.where(second.median_depth > 0, second.median_depth, own.median_depth)
    assert not torch.equal(expected, own.median_depth)
    assert torch.equal(once.median_depth, expected)


def test_looking_along_fewer_rays_after_more_is_as_if_it_were_the_first_look(scene):
    """The memory of what the first rays met is used again, and nothing in it counts."""
    renderer, rays = scene_renderer(scene)
    fresh, _ = scene_renderer(scene)
    values, rgb = to_renderer_order(renderer, scene.sigma), to_renderer_order(renderer, scene.rgb)
    few = Rays(rays.origins[::3], rays.directions[::3], rays.offsets[::3])
    renderer.render(rays, values, rgb)
    outputs = []
    for each in (renderer, fresh):
        leaf, confidence = values.clone().requires_grad_(), torch.zeros_like(values)
        rendered = each.render(few, leaf, rgb)
        (rendered.color.sum() + rendered.transmittance.sum()).backward()
        agreement = torch.linspace(0, 1, len(few))
        each.accumulate_confidence(values, agreement, confidence, **DEFAULT)
        outputs.append((rendered.color, rendered.transmittance, leaf.grad, confidence))
    assert all(torch.equal(again, first) for again, first in zip(*outputs, strict=True))


def test_the_way_back_is_refused_after_another_look(scene):
    renderer, rays = scene_renderer(scene)
    values = to_renderer_order(renderer, scene.sigma).requires_grad_()
    rgb = to_renderer_order(renderer, scene.rgb)
    rendered = renderer.render(rays, values, rgb)
    renderer.render(rays, values, rgb)
    with pytest.raises(RuntimeError, match="other rays since"):
        rendered.transmittance.sum().backward()


def test_rays_on_another_device_are_refused(scene):
    """A kernel would take their addresses for its own."""
    renderer, rays = scene_renderer(scene)
    values, rgb = (to_renderer_order(renderer, x) for x in (scene.sigma, scene.rgb))
    elsewhere = Rays(*(x.to("meta") for x in (rays.origins, rays.directions, rays.offsets)))
    with pytest.raises(RuntimeError, match="not all on one device"):
        renderer.render(elsewhere, values, rgb)
    with pytest.raises(RuntimeError, match="not all on one device"):
        renderer.render(rays, values.to("meta"), rgb)


def test_confidence_is_of_the_rays_last_looked_along(scene):
    renderer, rays = scene_renderer(scene)
    values = to_renderer_order(renderer, scene.sigma)
    renderer.render(rays, values, to_renderer_order(renderer, scene.rgb))
    confidence = torch.zeros_like(values)
    with pytest.raises(RuntimeError, match=f"agreement of 1 rays, {len(rays)} were rendered"):
        renderer.accumulate_confidence(values, torch.ones(1), confidence, **DEFAULT)


def test_what_is_found_on_a_lattice_is_what_a_search_finds():
    """But for roundings, on which no neighbor hangs here: `test_scenes`."""
    scene = SCENES["grid"]
    renderer, rays = scene_renderer(scene)
    values, rgb = to_renderer_order(renderer, scene.sigma), to_renderer_order(renderer, scene.rgb)
    assert renderer.points.cells.is_grid_aligned
    quick = renderer.render(rays, values, rgb)
    renderer.points.cells.is_grid_aligned = False
    slow = renderer.render(rays, values, rgb)
    for name, value in vars(slow).items():
        torch.testing.assert_close(getattr(quick, name), value, rtol=1e-5, atol=1e-5)


def test_a_ray_just_a_spacing_away_from_a_lattice_meets_nothing():
    """All tents end there: no weight is left to be divided by."""
    axis = torch.arange(-1.0, 1.5, 0.5)
    points = torch.cartesian_prod(axis, axis, axis)
    renderer = CompiledRenderer(
        PointGrid(points, 0.5, 8, "trilinear"), (-3.0,) * 3, (3.0,) * 3, 0.1, 0.0
    )
    assert renderer.points.cells.is_grid_aligned
    camera_center, ahead = torch.tensor([[-4.0, 0.0, 0.25]]), torch.tensor([[1.0, 0.0, 0.0]])
    values, rgb = torch.ones(len(points)), torch.ones(len(points), 3)
    for height, is_hit in ((-1.5, False), (-1.25, True)):
        camera_center[0, 1] = height
        rendered = renderer.render(Rays(camera_center, ahead, torch.tensor([0.5])), values, rgb)
        assert bool(rendered.transmittance < 1) is is_hit
        assert torch.isfinite(rendered.color).all()


@pytest.mark.parametrize(
    ("change", "settings"),
    [
        ("a point is off its place", {}),
        ("there is another", {}),
        ("none", {"radius": 0.3}),
        ("none", {"k": 4}),
        ("none", {"weights": "inverse"}),
    ],
)
def test_what_is_no_lattice_is_searched(change, settings):
    scene = SCENES["grid"].with_settings(**settings)
    points = scene.points.clone()
    if change == "a point is off its place":
        points[5, 1] += 1e-3
    if change == "there is another":
        points = torch.cat([points, points[5:6]])
    renderer, _ = scene_renderer(replace(scene, points=points))
    assert not renderer.points.cells.is_grid_aligned


def test_more_neighbors_than_can_be_numbered_are_refused():
    points = PointGrid(torch.zeros(1, 3), 1.0, 64, "inverse")
    renderer = CompiledRenderer(points, (-1.0,) * 3, (1.0,) * 3, 1e-3, 0.01)
    with pytest.raises(ReconstructionFailed, match="lower `rays_per_step` or `neighbors`"):
        renderer._neighbor_buffer(10_000)


def test_more_cells_than_fit_into_memory_are_refused():
    corners = torch.tensor([[-1.0, -1, -1], [1, 1, 1]])
    with pytest.raises(ReconstructionFailed, match="raise `neighbor_radius`"):
        PointGrid(corners, 1e-3, 8, "inverse")
