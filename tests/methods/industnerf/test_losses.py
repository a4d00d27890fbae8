"""What a step asks of its rays, at values that are told by hand."""

import pytest
import torch

from industnerf.methods.industnerf.losses import depth_loss, opacity_regularizer, photometric_loss
from industnerf.rendering.render import RenderOutput

TRANSMITTANCE = torch.tensor([0.0, 0.0, 0.5, 1.0])  # what is left of the light of four rays


def render_output(depth: tuple[float, ...] = (0.0,) * 4) -> RenderOutput:
    """Black rays."""
    return RenderOutput(torch.zeros(4, 3), TRANSMITTANCE, torch.tensor(depth), torch.tensor(depth))


def test_the_error_is_of_pixels_before_their_background():
    """Before white the rays are 0, 0, 0.5 and 1 bright."""
    target = torch.tensor([0.0, 0.2, 0.5, 0.9])[:, None].expand(4, 3)
    actual = photometric_loss(render_output(), torch.ones(4, 3), target)
    assert actual.item() == pytest.approx((0.2**2 + 0.1**2) / 4, rel=1e-5)


def test_emptiness_is_preferred_and_so_are_rays_that_end_or_pass():
    assert opacity_regularizer(
        render_output(), opacity_weight=2.0, binary_opacity_weight=0.0
    ).item() == pytest.approx(2 * 2.5 / 4)
    assert opacity_regularizer(
        render_output(), opacity_weight=0.0, binary_opacity_weight=2.0
    ).item() == pytest.approx(2 * 0.25 / 4)
    assert opacity_regularizer(render_output(), opacity_weight=0.0, binary_opacity_weight=0.0) == 0


def test_what_is_seen_is_held_against_the_readings_of_depth():
    """Four pixels: seen where the reading is, 0.3 behind it, half of it missed, and no reading."""
    measured = torch.tensor([3.0, 3.0, 3.0, 0.0])
    expected = (0.0 + 0.3 + (0.5 * 0.1 + 0.5) + 0.0) / 4
    actual = depth_loss(render_output((3.0, 3.3, 3.1, 0.0)), measured)
    assert actual.item() == pytest.approx(expected, rel=1e-5)
