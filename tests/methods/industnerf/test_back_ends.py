"""One small part, reconstructed on both back ends of the renderer."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from industnerf.methods.industnerf.pipeline import ReconstructionResult
from industnerf.rendering import torch_renderer
from industnerf.schema.industnerf import RendererName
from tests.methods.industnerf.results import run
from tests.methods.industnerf.synthetic_scenes import ball, default_settings, make_posed_images

STEPS = 6
SPACING_MM = 3.0  # of the points of the cloud: a tenth of the radius of the region of interest


def reconstruct(method: str, renderer: RendererName, num_levels: int = 2) -> ReconstructionResult:
    """A ball of 18 mm."""
    settings = default_settings(method)
    level = replace(settings.levels[0], steps=STEPS, image_px=32, points=2000)
    settings = replace(
        settings,
        levels=[level, replace(level, steps=2)][:num_levels],
        warm_up=replace(settings.warm_up, steps=0),
        fusion=replace(settings.fusion, grid_res=32, points=4000),
        grid_res=12,
        rays_per_step=256,
        surface_px=32,
        surface_spacing=0.1,
        renderer=renderer,
    )
    if method == "industnerf_plus":
        settings = replace(settings, polish=replace(settings.polish, enabled=False))
    return run(make_posed_images(ball(18.0)), settings, 1)


@pytest.mark.parametrize("method", ["industnerf", "nerf"])
def test_both_reconstruct_the_same(method):
    """They round differently, by 1e-6 of a pixel, and every step starts from the one before.

    A point of the cloud that is there on one side alone, because its confidence is at the
    threshold, has a neighbor within a spacing: 1 % of those leave the mean at a hundredth of it.
    """
    compiled, in_torch = (reconstruct(method, name) for name in ("compiled", "torch"))
    np.testing.assert_allclose(in_torch.losses[:STEPS], compiled.losses[:STEPS], rtol=1e-4)
    assert compiled.losses[STEPS - 1] < compiled.losses[0]
    for points, others in (
        (compiled.points, in_torch.points),
        (in_torch.points, compiled.points),
    ):
        distance, _ = cKDTree(others).query(points)
        assert distance.mean() < 0.01 * SPACING_MM
    np.testing.assert_allclose(
        in_torch.candidate_confidence.mean(), compiled.candidate_confidence.mean(), rtol=1e-3
    )


def test_an_edited_equation_11_changes_the_cloud(monkeypatch):
    """In torch; a tenth of (11) is a tenth of (13)."""
    before = reconstruct("nerf", "torch", 1).candidate_confidence
    equation_11 = torch_renderer.voxel_confidence
    monkeypatch.setattr(
        torch_renderer, "voxel_confidence", lambda *inputs: equation_11(*inputs) / 10
    )
    after = reconstruct("nerf", "torch", 1).candidate_confidence
    assert before.max() > 0.1
    assert after.max() == pytest.approx(before.max() / 10, rel=1e-3)
