"""The scenes are fit to hold a float32 renderer against a float64 one."""

from dataclasses import replace

import pytest
import torch

from industnerf.rendering.samples import radiance_points
from industnerf.rendering.torch_renderer import render_reference
from tests.rendering.scenes import SCENES, RenderScene


def samples_of(scene: RenderScene):
    settings = {
        name: value
        for name, value in scene.settings.items()
        if name not in ("early_stop_transmittance", "beta")
    }
    return radiance_points(*scene.rays, scene.points, **settings)


@pytest.mark.parametrize("name", SCENES)
def test_no_decision_hangs_on_a_rounding(name):
    """Which points are neighbors and where a ray ends is the same a few roundings away."""
    scene = SCENES[name]
    truth = render_reference(*scene.render_inputs, **scene.settings)
    # Coordinates up to 4 and paths of 64 steps: a float32 renderer is some 1e-6 off.  A neighbor
    # or a sample more or less would shift a pixel by 1e-3 and more; moving by 1e-6 an origin that
    # passes a point at 1e-2 shifts its weight, and at most the pixel, by 1e-4.
    for nudge in [[3e-6, 2e-6, 1e-6], [-2e-6, 1e-6, -3e-6], [1e-6, -3e-6, 2e-6]]:
        moved = replace(scene, origins=scene.origins + torch.tensor(nudge))
        rendered = render_reference(*moved.render_inputs, **scene.settings)
        torch.testing.assert_close(rendered.rgb, truth.rgb, rtol=0, atol=1e-4)
        torch.testing.assert_close(rendered.opacity, truth.opacity, rtol=0, atol=1e-4)


@pytest.mark.parametrize("name", SCENES)
def test_the_numbers_are_float32_ones(name):
    scene = SCENES[name]
    for mine, short in zip(scene.render_inputs, scene.to(torch.float32).render_inputs, strict=True):
        torch.testing.assert_close(short.to(torch.float64), mine, rtol=0, atol=0)


def test_the_scenes_hold_what_their_names_promise():
    neighbors = {name: (samples_of(scene).ids >= 0).sum(dim=2) for name, scene in SCENES.items()}
    inside = {name: samples_of(scene).t > 0 for name, scene in SCENES.items()}
    assert (neighbors["gappy"][inside["gappy"]] == 0).double().mean() > 0.2
    assert (neighbors["crowded"][inside["crowded"]] == 4).double().mean() > 0.8
    assert neighbors["inverse_square"].max() == 8
    assert (neighbors["single"] > 0).any()
    opaque, thin = (SCENES[name] for name in ("opaque", "thin"))
    assert (
        render_reference(*opaque.render_inputs, **opaque.settings).opacity > 0.99
    ).double().mean() > 0.5
    assert render_reference(*thin.render_inputs, **thin.settings).opacity.max() < 0.2


def test_some_rays_start_inside_and_two_never_come():
    scene = SCENES["gappy"]
    within = ((scene.origins > scene.lo) & (scene.origins < scene.hi)).all(dim=1)
    assert within.sum() >= 9
    assert (~(samples_of(scene).t > 0).any(dim=1)).nonzero().ravel().tolist() == [36, 37]
