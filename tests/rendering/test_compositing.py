import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.rendering.compositing import composite, opacities, terminated_density, transmittance

SEEDS = st.integers(0, 2**32 - 1)
STEP = 0.25
RED, BLUE, GRAY = [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.5, 0.5, 0.5]


def f64(*x) -> torch.Tensor:
    return torch.tensor(x, dtype=torch.float64)


def densities(*alpha: float) -> torch.Tensor:
    """One ray of samples with these opacities."""
    return f64([-math.log(1 - a) / STEP for a in alpha])


def random_rays(seed: int, rays: int = 5, samples: int = 12):
    """Densities (a third of them 0), colors, places and backgrounds."""
    rng = torch.Generator().manual_seed(seed)
    sigma = 20 * torch.rand(rays, samples, generator=rng, dtype=torch.float64) ** 3
    sigma[:, ::3] = 0
    rgb = torch.rand(rays, samples, 3, generator=rng, dtype=torch.float64)
    t = torch.rand(rays, samples, generator=rng, dtype=torch.float64).sort(dim=1).values
    return sigma, rgb, t, torch.rand(rays, 3, generator=rng, dtype=torch.float64)


def test_transmittance_by_hand():
    result = transmittance(f64([1.0, 2.0, 0.0]), 0.5)
    truth = f64([1.0, math.exp(-0.5), math.exp(-1.5), math.exp(-1.5)])
    torch.testing.assert_close(result, truth, rtol=1e-15, atol=0)


@given(SEEDS)
def test_transmittance_is_the_product_of_what_samples_let_through(seed):
    sigma = random_rays(seed)[0]
    through = torch.cumprod(1 - opacities(sigma, STEP), dim=1)
    # 1 - alpha loses up to 6e-17 / (1 - alpha), and 1 - alpha is at least exp(-5) = 7e-3
    torch.testing.assert_close(transmittance(sigma, STEP)[:, 1:], through, rtol=1e-12, atol=0)


def test_thin_samples_keep_their_digits():
    result = opacities(torch.tensor([[4e-10]], dtype=torch.float32), STEP)
    torch.testing.assert_close(result, torch.tensor([[1e-10]]), rtol=1e-6, atol=0)


def test_two_samples_by_hand():
    rendered = composite(densities(0.4, 0.8), f64([RED, BLUE]), f64([2.0, 5.0]), f64(GRAY), STEP)
    over = 0.4, 0.6 * 0.8, 0.6 * 0.2  # first, second, background
    truth = f64([over[0] + 0.5 * over[2], 0.5 * over[2], over[1] + 0.5 * over[2]])
    # log and exp cancel to a few eps, here and below
    torch.testing.assert_close(rendered.rgb, truth, rtol=1e-14, atol=0)
    torch.testing.assert_close(rendered.opacity, f64(1 - over[2]), rtol=1e-14, atol=0)
    depth = (2 * over[0] + 5 * over[1]) / (over[0] + over[1])
    torch.testing.assert_close(rendered.depth, f64(depth), rtol=1e-14, atol=0)


def test_an_opaque_sample_hides_the_rest():
    sigma, rgb = f64([0.0, 1e6, 3.0]), f64([RED, BLUE, RED])
    rendered = composite(sigma, rgb, f64([1.0, 2.0, 3.0]), f64(GRAY), STEP)
    assert rendered.rgb.tolist() == [BLUE]
    assert (rendered.opacity.item(), rendered.depth.item()) == (1, 2)


@pytest.mark.parametrize("samples", [0, 3])
def test_nothing_shows_the_background(samples):
    empty = torch.zeros(2, samples), torch.rand(2, samples, 3), torch.ones(2, samples)
    background = torch.rand(2, 3)
    rendered = composite(*empty, background, STEP)
    torch.testing.assert_close(rendered.rgb, background, rtol=0, atol=0)
    assert rendered.opacity.tolist() == rendered.depth.tolist() == [0, 0]


@given(SEEDS)
def test_pixels_are_mixtures(seed):
    """Colors in [0, 1] stay there, and the depth lies between the first and the last sample."""
    sigma, rgb, t, background = random_rays(seed)
    rendered = composite(sigma, rgb, t, background, STEP)
    for share in (rendered.rgb, rendered.opacity):
        assert (share >= 0).all()
        assert (share <= 1 + 1e-14).all()  # 12 weights that sum to 1 within a few eps
    assert (rendered.depth >= t[:, 0] - 1e-14).all()
    assert (rendered.depth <= t[:, -1] + 1e-14).all()


def test_a_ray_ends_at_the_sample_that_leaves_too_little():
    sigma = densities(0.5, 0.5, 0.0, 0.5)  # leaves 1/2, 1/4, 1/4, 1/8
    last = {0.0: 4, 0.1: 4, 0.2: 4, 0.3: 2, 0.6: 1}
    for early_stop, kept in last.items():
        result = terminated_density(sigma, STEP, early_stop)
        torch.testing.assert_close(result[:, :kept], sigma[:, :kept], rtol=0, atol=0)
        assert result[:, kept:].abs().sum() == 0


@given(SEEDS, st.floats(0, 0.3))
def test_ending_early_costs_at_most_what_was_left(seed, early_stop):
    sigma, rgb, t, background = random_rays(seed)
    full = composite(sigma, rgb, t, background, STEP)
    early = composite(terminated_density(sigma, STEP, early_stop), rgb, t, background, STEP)
    # What is dropped and what replaces it both weigh less than `early_stop`; colors are in [0, 1].
    assert (early.rgb - full.rgb).abs().max() <= early_stop + 1e-14
    assert (early.opacity - full.opacity).abs().max() <= early_stop + 1e-14


@pytest.mark.parametrize("early_stop", [0.0, 0.2])
def test_gradients(early_stop):
    sigma, rgb, t, background = (x.requires_grad_() for x in random_rays(3, rays=3, samples=6))

    def seen(*inputs):
        end = terminated_density(inputs[0], STEP, early_stop)
        return tuple(vars(composite(end, *inputs[1:], STEP)).values())

    # Transmittances stay clear of `early_stop` by more than gradcheck's nudge of 1e-6.
    assert (transmittance(sigma, STEP) - early_stop).abs().min() > 1e-4
    torch.autograd.gradcheck(seen, (sigma, rgb, t, background))
