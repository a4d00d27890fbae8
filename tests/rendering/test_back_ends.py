"""The torch back end against the compiled one, through their common interface, on every scene.

Both march in float32: tolerances are those of `test_kernels`.
"""

import pytest
import torch

from industnerf.rendering import torch_renderer
from industnerf.rendering.render import Rays, Renderer
from industnerf.rendering.sdf_density import density
from tests.rendering.scene_renderers import scene_renderer, to_renderer_order
from tests.rendering.scenes import SCENES, RenderScene

PRINTED = {"transmittance": "shared", "opacity": "without", "samples": "max"}
OURS = {"transmittance": "own", "opacity": "with", "samples": "sum"}


@pytest.fixture(params=SCENES)
def scene(request: pytest.FixtureRequest) -> RenderScene:
    return SCENES[request.param]


def back_ends(scene: RenderScene) -> tuple[Renderer, Renderer, Rays]:
    """Both, which skip what has no density; a surface half as soft counts for the median."""
    renderers = []
    for name in ("compiled", "torch"):
        renderer, rays = scene_renderer(scene, name=name)
        occupied = density(to_renderer_order(renderer, scene.sigma), renderer.beta) > 0
        if occupied.any():  # not the only point of "single"
            renderer.points.update_occupancy(occupied)
        renderer.median_beta = renderer.beta / 2
        renderers.append(renderer)
    return *renderers, rays


def test_both_see_the_same(scene):
    *renderers, rays = back_ends(scene)
    values = to_renderer_order(renderers[0], scene.sigma)
    rgb = to_renderer_order(renderers[0], scene.rgb)
    compiled, torch_output = (each.render(rays, values, rgb) for each in renderers)
    for name in ("color", "transmittance"):
        mine, truth = getattr(torch_output, name), getattr(compiled, name)
        torch.testing.assert_close(mine, truth, rtol=1e-4, atol=1e-5)
    solid = compiled.transmittance < 0.99  # above, 1 - T cancels in float32
    torch.testing.assert_close(
        torch_output.depth[solid], compiled.depth[solid], rtol=1e-3, atol=1e-4
    )
    clear = (compiled.transmittance - 0.5).abs() > 1e-3  # there is a median in both or in none
    torch.testing.assert_close(
        torch_output.median_depth[clear], compiled.median_depth[clear], rtol=1e-3, atol=1e-4
    )


def test_both_learn_the_same(scene):
    *renderers, rays = back_ends(scene)
    gradients = []
    for each in renderers:
        values, rgb = (
            to_renderer_order(each, x).requires_grad_() for x in (scene.sigma, scene.rgb)
        )
        output = each.render(rays, values, rgb)
        pull = torch.linspace(-1, 1, 3 * len(rays)).reshape(-1, 3)
        ((output.color * pull).sum() + output.transmittance @ pull[:, 0]).backward()
        gradients.append((values.grad, rgb.grad))
    for mine, truth in zip(gradients[1], gradients[0], strict=True):
        torch.testing.assert_close(mine, truth, rtol=1e-3, atol=1e-3 * truth.abs().max().item())


@pytest.mark.parametrize("readings", [PRINTED, OURS])
def test_both_believe_the_same(scene, readings):
    """Of two chunks of rays, one after the other."""
    results = []
    *renderers, rays = back_ends(scene)
    for each in renderers:
        values = to_renderer_order(each, scene.sigma)
        confidence = torch.zeros_like(values)
        for chunk in (slice(0, 15), slice(15, None)):
            part = Rays(rays.origins[chunk], rays.directions[chunk], rays.offsets[chunk])
            each.render(part, values, to_renderer_order(each, scene.rgb))
            agreement = scene.agreement[chunk].float()
            each.accumulate_confidence(values, agreement, confidence, **readings)
        results.append(confidence)
    assert results[0].any() or len(scene.points) == 1  # which has no density
    torch.testing.assert_close(results[1], results[0], rtol=1e-3, atol=1e-5)


def test_an_edited_equation_11_is_in_force_at_once(monkeypatch):
    """A tenth of it as long as the function is another one: nothing else has to be told."""
    scene = SCENES["gappy"]
    renderer, rays = scene_renderer(scene, name="torch")
    values, rgb = (to_renderer_order(renderer, x) for x in (scene.sigma, scene.rgb))

    def confidence() -> torch.Tensor:
        result = torch.zeros_like(values)
        renderer.render(rays, values, rgb)
        renderer.accumulate_confidence(values, scene.agreement.float(), result, **PRINTED)
        return result

    before, equation_11 = confidence(), torch_renderer.voxel_confidence
    monkeypatch.setattr(
        torch_renderer, "voxel_confidence", lambda *inputs: equation_11(*inputs) / 10
    )
    torch.testing.assert_close(confidence(), before / 10)
    assert before.max() > 0


@pytest.mark.parametrize("name", ["compiled", "torch"])
def test_both_refuse_other_rays_and_another_device(name):
    scene = SCENES["gappy"]
    renderer, rays = scene_renderer(scene, name=name)
    values, rgb = (to_renderer_order(renderer, x) for x in (scene.sigma, scene.rgb))
    confidence = torch.zeros_like(values)
    with pytest.raises(RuntimeError, match="agreement of 40 rays, 0 were rendered"):
        renderer.accumulate_confidence(values, scene.agreement.float(), confidence, **PRINTED)
    with pytest.raises(RuntimeError, match="not all on one device"):
        renderer.render(rays, values.to("meta"), rgb)


@pytest.mark.parametrize("name", ["compiled", "torch"])
def test_softness_of_the_median_follows_that_of_the_surface(name):
    renderer, _ = scene_renderer(SCENES["sdf"], name=name)
    renderer.median_beta = 0.3
    assert renderer.beta == pytest.approx(SCENES["sdf"].settings["beta"])
    renderer.beta = 0.2
    assert renderer.median_beta == pytest.approx(0.2)
    assert renderer.chunk_size >= 1
