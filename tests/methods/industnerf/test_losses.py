"""What a step asks of its rays, at values that are told by hand."""

import pytest
import torch

from industnerf.methods.industnerf.losses import error, off_depth, preference
from industnerf.rendering.render import Seen

THROUGH = torch.tensor([0.0, 0.0, 0.5, 1.0])  # what is left of the light of four rays


def seen(depth: tuple[float, ...] = (0.0,) * 4) -> Seen:
    """Black rays."""
    return Seen(torch.zeros(4, 3), THROUGH, torch.tensor(depth), torch.tensor(depth))


def test_the_error_is_of_pixels_before_their_background():
    """Before white the rays are 0, 0, 0.5 and 1 bright."""
    target = torch.tensor([0.0, 0.2, 0.5, 0.9])[:, None].expand(4, 3)
    found = error(seen(), torch.ones(4, 3), target)
    assert found.item() == pytest.approx((0.2**2 + 0.1**2) / 4, rel=1e-5)


def test_emptiness_is_preferred_and_so_are_rays_that_end_or_pass():
    assert preference(seen(), emptiness=2.0, veil=0.0).item() == pytest.approx(2 * 2.5 / 4)
    assert preference(seen(), emptiness=0.0, veil=2.0).item() == pytest.approx(2 * 0.25 / 4)
    assert preference(seen(), emptiness=0.0, veil=0.0) == 0


def test_what_is_seen_is_held_against_the_readings_of_depth():
    """Four pixels: seen where the reading is, 0.3 behind it, half of it missed, and no reading."""
    read = torch.tensor([3.0, 3.0, 3.0, 0.0])
    expected = 2.0 * (0.0 + 0.3 + (0.5 * 0.1 + 0.5) + 0.0) / 4
    found = off_depth(seen((3.0, 3.3, 3.1, 0.0)), read, 2.0)
    assert found.item() == pytest.approx(expected, rel=1e-5)
    assert off_depth(seen(), None, 2.0) == 0
