"""Pooling over views: slow twins, views of more and less confidence, and gradients."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.methods.industnerf.pooling import (
    MIN_VIEW_WEIGHT,
    attach_gradient,
    pool,
    pooled_channels,
    pooling_weights,
)

SEEDS = st.integers(0, 2**32 - 1)
READINGS = ["confidence_weighted", "all", "mean_variance", "mean", "argmax_confidence", "max"]
every_reading = pytest.mark.parametrize("reading", READINGS)


def random_views(seed: int) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Features of 5 views, 9 points and 3 channels; each point is in 0 to 5 views; and trust."""
    generator = torch.Generator().manual_seed(seed)
    features = torch.randn(5, 9, 3, dtype=torch.float64, generator=generator) + 1
    valid = torch.rand(5, 9, generator=generator) < torch.linspace(0, 1, 9)
    return features, valid, torch.rand(5, 9, dtype=torch.float64, generator=generator)


def pooled(features: torch.Tensor, valid: torch.Tensor, view_weights: torch.Tensor, reading: str):
    return pool(features, valid, pooling_weights(valid, view_weights, reading), reading)


def pool_slowly(
    features: torch.Tensor, valid: torch.Tensor, view_weights: torch.Tensor, reading: str
):
    """Point by point, of the views that it is in; differentiable."""
    rows = []
    for n in range(features.shape[1]):
        view_features = features[valid[:, n], n]
        if not len(view_features):
            rows.append(features.new_zeros(pooled_channels(features.shape[2], reading)))
            continue
        confidence = view_weights[valid[:, n], n]
        unnormalized = (
            confidence + MIN_VIEW_WEIGHT
            if reading == "confidence_weighted"
            else torch.ones_like(confidence)
        )
        weight = (unnormalized / unnormalized.sum())[:, None]
        mean = (weight * view_features).sum(0)
        columns = {
            "mean": [mean],
            "argmax_confidence": [view_features[confidence.argmax()]],
            "max": [view_features.amax(0)],
            "mean_variance": [mean, (weight * (view_features - mean) ** 2).sum(0)],
        }
        statistics = columns.get(reading) or [
            *columns["mean_variance"],
            view_features.amin(0),
            view_features.amax(0),
        ]
        rows.append(
            torch.cat([*statistics, view_features.new_tensor([len(view_features) / len(valid)])])
        )
    return torch.stack(rows)


@every_reading
@given(SEEDS)
def test_each_point_pools_the_views_that_it_is_in(reading, seed):
    inputs = random_views(seed)
    # five terms of order 1 in another order; the variance is a difference of squares
    expected = pool_slowly(*inputs, reading)
    torch.testing.assert_close(pooled(*inputs, reading), expected, rtol=0, atol=1e-13)


@every_reading
def test_what_is_out_of_view_has_no_effect(reading):
    features, valid, view_weights = random_views(0)
    with_nan = features.masked_fill(~valid[..., None], torch.nan)
    actual = pooled(with_nan, valid, view_weights, reading)
    assert torch.equal(actual, pooled(features, valid, view_weights, reading))


@every_reading
@given(SEEDS)
def test_gradients_of_some_views_are_those_of_pooling_all(reading, seed):
    """Of two of the five, whatever they are out of view; the slow twin is differentiated whole."""
    features, valid, view_weights = random_views(seed)
    selected = torch.tensor([3, 1])
    cotangent = torch.linspace(-1, 1, 9 * pooled_channels(3, reading), dtype=torch.float64)
    cotangent = cotangent.reshape(9, -1)
    all_features = features.clone().requires_grad_()
    (pool_slowly(all_features, valid, view_weights, reading) * cotangent).sum().backward()
    view_features = features.masked_fill(~valid[..., None], torch.nan)[selected].requires_grad_()
    weights = pooling_weights(valid, view_weights, reading)
    all_of_them = pool(features, valid, weights, reading)
    attached = attach_gradient(
        all_of_them, view_features, valid[selected], weights[selected], reading
    )
    torch.testing.assert_close(attached, all_of_them, rtol=0, atol=1e-15)
    (attached * cotangent).sum().backward()
    torch.testing.assert_close(view_features.grad, all_features.grad[selected], rtol=0, atol=1e-13)


@every_reading
def test_the_order_of_the_views_does_not_matter(reading):
    inputs = random_views(2)
    reversed_order = pooled(*(x.flip(0) for x in inputs), reading)
    torch.testing.assert_close(reversed_order, pooled(*inputs, reading), rtol=0, atol=1e-13)


def test_who_is_sure_counts_more():
    """Two views, one sure and one not at all: the mean is the first's but for the doubt."""
    features = torch.tensor([[[4.0]], [[8.0]]])
    valid, view_weights = torch.ones(2, 1, dtype=torch.bool), torch.tensor([[1.0], [0.0]])
    mean = pooled(features, valid, view_weights, "confidence_weighted")[0, 0].item()
    assert mean == pytest.approx(
        (4 * (1 + MIN_VIEW_WEIGHT) + 8 * MIN_VIEW_WEIGHT) / (1 + 2 * MIN_VIEW_WEIGHT)
    )


def test_before_anybody_was_asked_all_count_alike():
    features, valid, _ = random_views(3)
    weighted = pool(
        features, valid, pooling_weights(valid, None, "confidence_weighted"), "confidence_weighted"
    )
    unweighted = pool(features, valid, pooling_weights(valid, None, "all"), "all")
    assert torch.equal(weighted, unweighted)


def test_as_long_as_no_view_was_asked_the_surest_is_the_first_that_has_the_point():
    features, valid, _ = random_views(3)
    actual = pool(
        features, valid, pooling_weights(valid, None, "argmax_confidence"), "argmax_confidence"
    )[:, :-1]
    for n in range(9):
        view_features = features[valid[:, n], n]
        assert torch.equal(
            actual[n], view_features[0] if len(view_features) else torch.zeros_like(actual[n])
        )
