"""Pooling over views: slow twins, views of more and less confidence, and gradients."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.methods.industnerf.pooling import DOUBT, felt, pool, pooled_channels, weights_of

SEEDS = st.integers(0, 2**32 - 1)
READINGS = ["confident", "all", "mean_variance", "mean", "surest", "max"]
every_reading = pytest.mark.parametrize("reading", READINGS)


def views(seed: int) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Features of 5 views, 9 points and 3 channels; each point is in 0 to 5 views; and trust."""
    generator = torch.Generator().manual_seed(seed)
    features = torch.randn(5, 9, 3, dtype=torch.float64, generator=generator) + 1
    valid = torch.rand(5, 9, generator=generator) < torch.linspace(0, 1, 9)
    return features, valid, torch.rand(5, 9, dtype=torch.float64, generator=generator)


def pooled(features: torch.Tensor, valid: torch.Tensor, trust: torch.Tensor, reading: str):
    return pool(features, valid, weights_of(valid, trust, reading), reading)


def slowly(features: torch.Tensor, valid: torch.Tensor, trust: torch.Tensor, reading: str):
    """Point by point, of the views that it is in; differentiable."""
    rows = []
    for n in range(features.shape[1]):
        seen = features[valid[:, n], n]
        if not len(seen):
            rows.append(features.new_zeros(pooled_channels(features.shape[2], reading)))
            continue
        sure = trust[valid[:, n], n]
        counts = sure + DOUBT if reading == "confident" else torch.ones_like(sure)
        weight = (counts / counts.sum())[:, None]
        mean = (weight * seen).sum(0)
        columns = {
            "mean": [mean],
            "surest": [seen[sure.argmax()]],
            "max": [seen.amax(0)],
            "mean_variance": [mean, (weight * (seen - mean) ** 2).sum(0)],
        }
        some = columns.get(reading) or [*columns["mean_variance"], seen.amin(0), seen.amax(0)]
        rows.append(torch.cat([*some, seen.new_tensor([len(seen) / len(valid)])]))
    return torch.stack(rows)


@every_reading
@given(SEEDS)
def test_each_point_pools_the_views_that_it_is_in(reading, seed):
    given_to = views(seed)
    # five terms of order 1 in another order; the variance is a difference of squares
    expected = slowly(*given_to, reading)
    torch.testing.assert_close(pooled(*given_to, reading), expected, rtol=0, atol=1e-13)


@every_reading
def test_what_is_out_of_view_has_no_effect(reading):
    features, valid, trust = views(0)
    wild = features.masked_fill(~valid[..., None], torch.nan)
    found = pooled(wild, valid, trust, reading)
    assert torch.equal(found, pooled(features, valid, trust, reading))


@every_reading
@given(SEEDS)
def test_gradients_of_some_views_are_those_of_pooling_all(reading, seed):
    """Of two of the five, whatever they are out of view; the slow twin is differentiated whole."""
    features, valid, trust = views(seed)
    which = torch.tensor([3, 1])
    pull = torch.linspace(-1, 1, 9 * pooled_channels(3, reading), dtype=torch.float64)
    pull = pull.reshape(9, -1)
    whole = features.clone().requires_grad_()
    (slowly(whole, valid, trust, reading) * pull).sum().backward()
    fresh = features.masked_fill(~valid[..., None], torch.nan)[which].requires_grad_()
    weights = weights_of(valid, trust, reading)
    all_of_them = pool(features, valid, weights, reading)
    moved = felt(all_of_them, fresh, valid[which], weights[which], reading)
    torch.testing.assert_close(moved, all_of_them, rtol=0, atol=1e-15)
    (moved * pull).sum().backward()
    torch.testing.assert_close(fresh.grad, whole.grad[which], rtol=0, atol=1e-13)


@every_reading
def test_the_order_of_the_views_does_not_matter(reading):
    given_to = views(2)
    turned = pooled(*(x.flip(0) for x in given_to), reading)
    torch.testing.assert_close(turned, pooled(*given_to, reading), rtol=0, atol=1e-13)


def test_who_is_sure_counts_more():
    """Two views, one sure and one not at all: the mean is the first's but for the doubt."""
    features = torch.tensor([[[4.0]], [[8.0]]])
    valid, trust = torch.ones(2, 1, dtype=torch.bool), torch.tensor([[1.0], [0.0]])
    mean = pooled(features, valid, trust, "confident")[0, 0].item()
    assert mean == pytest.approx((4 * (1 + DOUBT) + 8 * DOUBT) / (1 + 2 * DOUBT))


def test_before_anybody_was_asked_all_count_alike():
    features, valid, _ = views(3)
    found = pool(features, valid, weights_of(valid, None, "confident"), "confident")
    alike = pool(features, valid, weights_of(valid, None, "all"), "all")
    assert torch.equal(found, alike)


def test_as_long_as_no_view_was_asked_the_surest_is_the_first_that_has_the_point():
    features, valid, _ = views(3)
    found = pool(features, valid, weights_of(valid, None, "surest"), "surest")[:, :-1]
    for n in range(9):
        seen = features[valid[:, n], n]
        assert torch.equal(found[n], seen[0] if len(seen) else torch.zeros_like(found[n]))
