"""Confidence of points in scenes with a closed form: a slab, two planes, a faint veil."""

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.rendering.confidence import (
    color_confidence,
    color_scale,
    max_over_views,
    point_confidence,
    reduce_samples,
    voxel_confidence,
)

EXACT = {"rtol": 0, "atol": 1e-14}


def doubles(*values: float) -> torch.Tensor:
    return torch.tensor(values, dtype=torch.float64)


@pytest.mark.parametrize(
    ("reading", "opacity", "factor"),
    [
        ("shared", "without", 1),
        ("own", "without", math.exp(-0.3)),
        ("shared", "with", 1 - math.exp(-0.3)),
        ("own", "with", math.exp(-0.3) * (1 - math.exp(-0.3))),
    ],
)
def test_in_a_slab_confidence_falls_exponentially(reading, opacity, factor):
    """Optical depth 0.3 a sample: T_i = exp(-0.3 i), alpha = 1 - exp(-0.3)."""
    transmittance = torch.exp(-0.3 * torch.arange(9, dtype=torch.float64))
    alpha = torch.full((9,), 1 - math.exp(-0.3), dtype=torch.float64)
    weights = doubles(4, 2, 1).expand(9, 3)
    result = voxel_confidence(transmittance, weights, alpha, reading, opacity)
    expected = factor * transmittance[:, None] * doubles(1, 0.5, 0.25)
    torch.testing.assert_close(result, expected, **EXACT)


def test_the_second_of_two_planes_has_what_the_first_lets_through():
    alpha = doubles(0.8, 1)
    result = voxel_confidence(doubles(1, 0.2), torch.ones(2, 1).double(), alpha, "shared", "with")
    torch.testing.assert_close(result[:, 0], doubles(0.8, 0.2), **EXACT)
    behind = voxel_confidence(doubles(1, 0.2), torch.ones(2, 1).double(), alpha, "own", "without")
    torch.testing.assert_close(behind[:, 0], doubles(0.2, 0), **EXACT)


def test_a_faint_veil_before_the_surface_is_sure_only_without_opacity():
    transmittance, alpha = doubles(1, 0.99), doubles(0.01, 1)
    weights = torch.ones(2, 1, dtype=torch.float64)
    without_opacity = voxel_confidence(transmittance, weights, alpha, "shared", "without")
    torch.testing.assert_close(without_opacity[:, 0], doubles(1, 0.99), **EXACT)
    with_opacity = voxel_confidence(transmittance, weights, alpha, "shared", "with")
    torch.testing.assert_close(with_opacity[:, 0], doubles(0.01, 0.99), **EXACT)


def test_samples_without_neighbors_give_nothing():
    weights = torch.tensor([[0.0, 0], [2, 0]])
    result = voxel_confidence(torch.ones(2), weights, torch.ones(2), "shared", "without")
    assert result.tolist() == [[0, 0], [1, 0]]


def uniform(*shape: int) -> torch.Tensor:
    """In [0.1, 0.9], no two of them near each other."""
    count = math.prod(shape)
    order = torch.randperm(count, generator=torch.Generator().manual_seed(count))
    return (0.1 + 0.8 * order.double() / count).reshape(shape).requires_grad_()


@pytest.mark.parametrize("opacity", ["with", "without"])
@pytest.mark.parametrize("reading", ["shared", "own"])
def test_gradients_of_11_are_right(reading, opacity):
    """Away from where two weights are the largest.  A slot without a neighbor has none."""
    missing = torch.tensor([[0, 0, 1], [0, 0, 0]], dtype=torch.bool)

    def voxel(transmittance, weights, alpha):
        there = weights.masked_fill(missing, 0)
        return voxel_confidence(transmittance, there, alpha, reading, opacity)

    assert torch.autograd.gradcheck(voxel, (uniform(5, 2), uniform(5, 2, 3), uniform(5, 2)))


@pytest.mark.parametrize("reading", ["max", "sum"])
def test_gradients_of_12_and_13_are_right(reading):
    """From colors to the surest view; one pixel is off by more than the scale and says nothing."""
    observed, rendered = uniform(4, 3), uniform(4, 4, 3)[0].detach().requires_grad_()
    ids = torch.tensor([0, 1, 1, 2, -1, 0])

    def confidence(observed, rendered, voxel):
        each = point_confidence(color_confidence(observed, rendered, 0.7), voxel)
        return max_over_views(
            torch.stack([reduce_samples(one.flatten(), ids, 3, reading) for one in each])
        )[0]

    agreement = color_confidence(observed, rendered, 0.7)
    assert (agreement == 0).sum() == 1
    assert torch.autograd.gradcheck(confidence, (observed, rendered, uniform(4, 3, 2)))


@given(st.integers(0, 2**32 - 1), st.sampled_from(["shared", "own"]))
def test_many_rays_are_as_one_after_another_and_stay_within_one(seed, reading):
    generator = torch.Generator().manual_seed(seed)
    transmittance, alpha = torch.rand(2, 4, 6, generator=generator)
    weights = torch.rand(4, 6, 3, generator=generator)
    agreement = torch.rand(4, generator=generator)
    for opacity in ("with", "without"):
        voxel = voxel_confidence(transmittance, weights, alpha, reading, opacity)
        together = point_confidence(agreement, voxel)
        alone = [
            point_confidence(s, voxel_confidence(t, w, a, reading, opacity))
            for s, t, w, a in zip(agreement, transmittance, weights, alpha, strict=True)
        ]
        torch.testing.assert_close(together, torch.stack(alone), rtol=0, atol=0)
        assert ((together >= 0) & (together <= 1)).all()


def test_a_point_is_as_sure_as_its_ray_agrees_in_color():
    voxel = doubles(1, 0.5, 0.2, 0).reshape(2, 1, 2)
    result = point_confidence(doubles(0.5, 0.1), voxel)
    torch.testing.assert_close(result.flatten(), doubles(0.5, 0.25, 0.02, 0), **EXACT)
    torch.testing.assert_close(point_confidence(torch.tensor(0.5), voxel[0]), result[0], **EXACT)


def test_scales_of_color():
    assert color_scale("max", 0.2) == pytest.approx(math.sqrt(3), abs=1e-15)
    assert color_scale("unit", 0.2) == 1
    assert color_scale("contrast", 0.2) == 0.2


def test_color_confidence_falls_from_one_at_no_error_to_zero_at_the_scale():
    observed = torch.zeros(4, 3, dtype=torch.float64)
    rendered = torch.stack(
        [doubles(0, 0, 0), doubles(0.3, 0, 0.4), doubles(0, 1, 0), doubles(1, 1, 1)]
    )
    root = math.sqrt(3)
    for scale, expected in ((1.0, [1, 0.5, 0, 0]), (root, [1, 1 - 0.5 / root, 1 - 1 / root, 0])):
        result = color_confidence(observed, rendered, scale)
        torch.testing.assert_close(result, doubles(*expected), **EXACT)


@pytest.mark.parametrize(
    ("reading", "expected"),
    [("max", [0.5, 0, 0.9]), ("sum", [0.75, 0, 1.2])],
)
def test_samples_of_a_view_reduce_to_one_value_a_point(reading, expected):
    ids = torch.tensor([2, 0, 2, -1, 0, 2])
    result = reduce_samples(doubles(0.1, 0.5, 0.9, 1, 0.25, 0.2), ids, 3, reading)
    torch.testing.assert_close(result, doubles(*expected), **EXACT)


def test_the_best_view_wins_the_first_of_equals_and_none_of_none():
    per_view = torch.tensor([[0.1, 0.7, 0, 0.3], [0.4, 0.7, 0, 0.2]])
    confidence, view = max_over_views(per_view)
    torch.testing.assert_close(confidence, torch.tensor([0.4, 0.7, 0, 0.3]), rtol=0, atol=0)
    assert view.tolist() == [1, 0, -1, 0]


def test_more_views_never_lower_a_confidence():
    """The first of the two properties that 3.4 claims."""
    per_view = torch.rand(6, 40, generator=torch.Generator().manual_seed(0))
    grown = torch.stack([max_over_views(per_view[: n + 1])[0] for n in range(6)])
    assert (grown.diff(dim=0) >= 0).all()
