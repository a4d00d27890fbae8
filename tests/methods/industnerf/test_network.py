"""The network starts uniform, and activations are densities that can be zero or say that not."""

import math
from itertools import pairwise

import pytest
import torch

from industnerf.methods.industnerf.network import COLOR_EPS, Network, activate

READINGS = ["sdf", "truncated_exp", "relu", "softplus"]


def test_it_starts_with_one_density_and_the_colors_it_is_given():
    colors = torch.rand(30, 3)
    raw, rgb = Network(10, 16, 2, density_bias=-1.5, density_scale=3.0)(torch.randn(30, 10), colors)
    assert (raw == -1.5).all()
    torch.testing.assert_close(rgb, colors.clamp(COLOR_EPS, 1 - COLOR_EPS))


@pytest.mark.parametrize("layers", [0, 1, 3])
def test_it_has_the_layers_asked_for(layers):
    net = Network(10, 16, layers, density_bias=0.0, density_scale=3.0)
    widths = [10, *[16] * layers, 4]
    expected = sum(a * b + b for a, b in pairwise(widths)) + 10 * 4  # and straight
    assert sum(p.numel() for p in net.parameters()) == expected


def test_it_learns_density_and_color():
    """One inside, one outside, of two colors: each to a hundredth of the start's error."""
    torch.manual_seed(0)
    net = Network(3, 16, 2, density_bias=0.0, density_scale=3.0)
    x = torch.tensor([[1.0, 0, 0], [0, 1, 0]])
    raw, rgb = torch.tensor([3.0, -6]), torch.tensor([[0.9, 0.1, 0.1], [0.2, 0.8, 0.5]])
    optimizer, losses = torch.optim.Adam(net.parameters(), 1e-2), []
    for _ in range(200):
        predicted = net(x, torch.full((2, 3), 0.5))
        loss = torch.stack(
            [(predicted[0] - raw).square().mean(), (predicted[1] - rgb).square().mean()]
        )
        optimizer.zero_grad()
        loss.sum().backward()
        optimizer.step()
        losses.append(loss.detach())
    assert (losses[-1] < losses[0] / 100).all()


@pytest.mark.parametrize(
    ("reading", "expected"),
    [
        ("sdf", lambda raw: raw / 16),
        ("truncated_exp", lambda raw: max(math.exp(min(raw, 4)) - math.exp(-6), 0)),
        ("relu", lambda raw: max(raw, 0)),
        ("softplus", lambda raw: math.log1p(math.exp(raw))),
    ],
)
def test_activations_are_what_they_say_per_unit(reading, expected):
    raw = torch.linspace(-9, 9, 37, dtype=torch.float64)
    truth = torch.tensor([expected(float(x)) / 0.25 for x in raw], dtype=torch.float64)
    torch.testing.assert_close(activate(raw, reading, 0.25, 4.0), truth, rtol=1e-13, atol=1e-17)


def test_only_softplus_is_never_zero():
    low = torch.tensor([-6.0, -7, -50])
    assert (activate(low, "truncated_exp", 1.0, 4.0) == 0).all()
    assert (activate(low, "relu", 1.0, 4.0) == 0).all()
    assert (activate(low, "softplus", 1.0, 4.0) > 0).all()


@pytest.mark.parametrize("reading", READINGS[1:])
def test_densities_are_finite_and_not_negative_with_finite_gradients(reading):
    raw = torch.tensor([-1e30, -100, -6, 0, 4, 100, 1e30]).requires_grad_()
    sigma = activate(raw, reading, 0.1, 4.0)
    assert (sigma >= 0).all()
    assert sigma.isfinite().all()
    sigma.sum().backward()
    assert raw.grad.isfinite().all()


@pytest.mark.parametrize("reading", READINGS)
def test_gradients_are_right_away_from_kinks(reading):
    raw = torch.tensor([-8.0, -5, -0.5, 0.7, 3.9, 6], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(lambda raw: activate(raw, reading, 0.5, 4.0), raw)


def test_gradients_of_the_whole_network():
    """After a few random steps, for at the start its last layers are zero.

    Inputs are so few that none is within gradcheck's nudge of 1e-6 of a rectifier's kink.
    """
    torch.manual_seed(0)
    net = Network(5, 6, 2, density_bias=-1.0, density_scale=3.0).double()
    with torch.no_grad():
        for weights in net.parameters():
            weights += 0.3 * torch.randn_like(weights)
    inputs = torch.randn(4, 5, dtype=torch.float64, requires_grad=True)
    colors = (0.1 + 0.8 * torch.rand(4, 3, dtype=torch.float64)).requires_grad_()
    assert torch.autograd.gradcheck(net, (inputs, colors))
    learned = dict(net.named_parameters())

    def forward_with(*values):
        parameters = dict(zip(learned, values, strict=True))
        return torch.func.functional_call(net, parameters, (inputs.detach(), colors.detach()))

    assert torch.autograd.gradcheck(forward_with, tuple(learned.values()))


def test_pruning_sets_the_smallest_weights_to_0_for_good():
    torch.manual_seed(0)
    net = Network(10, 16, 2, density_bias=-1.0, density_scale=3.0)
    with torch.no_grad():
        net.skip.weight += 0.5  # large: these stay
        net.head.weight += 1e-4  # small: these go
    weights = 10 * 16 + 16 * 16 + 16 * 4 + 10 * 4
    assert net.num_pruned == 0
    net.prune(0.5)
    assert net.num_pruned == weights // 2
    assert (net.head.weight == 0).all()
    assert (net.skip.weight != 0).all()
    assert net.head.bias[0].item() == pytest.approx(-1 / 3)
    optimizer = torch.optim.Adam(net.parameters(), 0.1)
    for _ in range(3):
        raw, rgb = net(torch.randn(30, 10), torch.rand(30, 3))
        optimizer.zero_grad()
        (raw.sum() + rgb.sum()).backward()
        optimizer.step()
    net(torch.randn(1, 10), torch.rand(1, 3))
    assert (net.head.weight == 0).all()
    assert (net.skip.weight != 0.5).any()
