"""Pooling over views: slow twins, points in no view, and sums that views enter and leave."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.methods.industnerf.pooling import PooledSums, pool, pooled_channels

SEEDS = st.integers(0, 2**32 - 1)
READINGS = ["mean_variance", "mean", "max"]
CPU = torch.device("cpu")


def views(seed: int, dtype: torch.dtype = torch.float64) -> tuple[torch.Tensor, torch.Tensor]:
    """Features of 5 views, 9 points and 3 channels; each point is in 0 to 5 views."""
    generator = torch.Generator().manual_seed(seed)
    features = torch.randn(5, 9, 3, dtype=dtype, generator=generator) + 1
    return features, torch.rand(5, 9, generator=generator) < torch.linspace(0, 1, 9)


def slowly(features: torch.Tensor, valid: torch.Tensor, reading: str) -> torch.Tensor:
    """Point by point, of the views that it is in."""
    rows = []
    for n in range(features.shape[1]):
        seen = features[valid[:, n], n]
        if not len(seen):
            rows.append(features.new_zeros(pooled_channels(features.shape[2], reading)))
            continue
        first = seen.amax(0) if reading == "max" else seen.mean(0)
        second = [seen.var(0, unbiased=False)] if reading == "mean_variance" else []
        rows.append(torch.cat([first, *second, seen.new_tensor([len(seen) / len(valid)])]))
    return torch.stack(rows)


@pytest.mark.parametrize("reading", READINGS)
@given(SEEDS)
def test_each_point_pools_the_views_that_it_is_in(reading, seed):
    features, valid = views(seed)
    # five terms of order 1 in another order
    torch.testing.assert_close(
        pool(features, valid, reading), slowly(features, valid, reading), rtol=0, atol=1e-13
    )


@pytest.mark.parametrize("reading", READINGS)
def test_what_is_out_of_view_has_no_effect_and_no_gradient(reading):
    features, valid = views(0)
    expected = pool(features, valid, reading)
    wild = features.masked_fill(~valid[..., None], torch.nan).requires_grad_()
    found = pool(wild, valid, reading)
    torch.testing.assert_close(found, expected, rtol=0, atol=0)
    found.sum().backward()
    assert wild.grad.isfinite().all()
    assert (wild.grad[~valid] == 0).all()


@pytest.mark.parametrize("reading", READINGS)
def test_gradients_are_right(reading):
    features, valid = views(1)
    assert torch.autograd.gradcheck(lambda f: pool(f, valid, reading), features.requires_grad_())


@pytest.mark.parametrize("reading", READINGS)
def test_the_order_of_the_views_does_not_matter(reading):
    features, valid = views(2)
    turned = pool(features.flip(0), valid.flip(0), reading)
    torch.testing.assert_close(turned, pool(features, valid, reading), rtol=0, atol=1e-13)


@given(SEEDS)
def test_running_sums_say_what_pool_says(seed):
    """Views come in twos and threes, one of them leaves and another takes its place."""
    features, valid = views(seed)
    other, other_valid = views(seed + 1)
    sums = PooledSums(9, 3, torch.float64, CPU)
    sums.add(features[:2], valid[:2])
    sums.add(features[2:], valid[2:])
    sums.remove(features[1:2], valid[1:2])
    sums.add(other[1:2], other_valid[1:2])
    features[1], valid[1] = other[1], other_valid[1]
    # The variance is a difference of squares of up to 25: rounded by 1e-15 of that a few times.
    torch.testing.assert_close(
        sums.pooled(), pool(features, valid, "mean_variance"), rtol=0, atol=1e-12
    )


def test_running_sums_of_float32_do_not_drift():
    features, valid = views(3, torch.float32)
    sums = PooledSums(9, 3, torch.float32, CPU)
    sums.add(features, valid)
    before = sums.pooled()
    assert before.dtype == torch.float32
    for turn in range(300):
        other, other_valid = views(turn, torch.float32)
        sums.add(other * 100, other_valid)
        sums.remove(other * 100, other_valid)
    # Squares of 24-bit numbers have 48 bits, and the sums, of up to 1e6, keep 53: each of the
    # 600 changes rounds by 1e-10 at most.  Sums in float32 are off by 5e-3 here.
    torch.testing.assert_close(sums.pooled(), before, rtol=1e-6, atol=1e-7)


def test_running_sums_find_a_small_variance_about_a_large_mean():
    features, valid = views(6, torch.float32)
    features += 1000
    sums = PooledSums(9, 3, torch.float32, CPU)
    sums.add(features, valid)
    expected = pool(features.double(), valid, "mean_variance").float()
    # The variance, of order 1, is what is left of squares of 1e6, rounded by 1e-10 in float64;
    # in float32 by 0.1.
    torch.testing.assert_close(sums.pooled(), expected, rtol=1e-6, atol=1e-9)


def test_running_sums_differentiate_what_was_added_last():
    features, valid = views(4)

    def pooled(last: torch.Tensor) -> torch.Tensor:
        sums = PooledSums(9, 3, torch.float64, CPU)
        sums.add(features[:3], valid[:3])
        sums.add(last, valid[3:])
        return sums.pooled()

    assert torch.autograd.gradcheck(pooled, features[3:].clone().requires_grad_())


def test_running_sums_forget_the_graph_of_what_was_added_before():
    features, valid = views(5)
    sums = PooledSums(9, 3, torch.float64, CPU)
    for _ in range(3):
        added = features.clone().requires_grad_()
        sums.add(added, valid)
        sums.pooled().sum().backward()  # raises if an earlier graph is still held
        assert (added.grad[valid] != 0).any()
        sums.remove(added, valid)


def test_empty_sums_are_zero():
    assert not PooledSums(4, 2, torch.float64, CPU).pooled().any()
