"""The compiled form of each equation, one sample of a ray, against its form in torch.

float32, compiled with fast exponentials: a few roundings, 1e-5 of the value.
"""

from typing import no_type_check

import pytest
import torch
import warp as wp

from industnerf.geometry.warp_runtime import init_warp
from industnerf.rendering.compositing import (
    median_depth,
    median_depth_wp,
    opacities,
    opacity_wp,
    render_weight_wp,
    render_weights,
    sample_transmittance_wp,
    transmittance,
)
from industnerf.rendering.confidence import (
    point_confidence,
    point_confidence_wp,
    reduce_sample_wp,
    reduce_samples,
    voxel_confidence,
)
from industnerf.rendering.sdf_density import density, density_derivative_wp, density_wp

init_warp()
STEP = 0.25
COUNT, NEIGHBORS = 200, 4
CLOSE = {"rtol": 1e-5, "atol": 1e-6}


def uniform(*shape: int) -> torch.Tensor:
    return torch.rand(shape, generator=torch.Generator().manual_seed(len(shape)))


@wp.kernel
@no_type_check
def march(
    sigma: wp.array(dtype=wp.float32),
    t: wp.array(dtype=wp.float32),
    step: wp.float32,
    remaining: wp.array(dtype=wp.float32),
    alpha: wp.array(dtype=wp.float32),
    weight: wp.array(dtype=wp.float32),
    median: wp.array(dtype=wp.float32),
):
    """One ray."""
    T = wp.float32(1.0)
    half = wp.float32(-1.0)
    for i in range(sigma.shape[0]):
        transmitted = sample_transmittance_wp(sigma[i], step)
        alpha[i] = opacity_wp(transmitted)
        weight[i] = render_weight_wp(T, alpha[i])
        half = median_depth_wp(half, T, sigma[i], t[i], step)
        T = T * transmitted
        remaining[i] = T
    median[0] = half


@pytest.mark.parametrize("total", [0.5, 3.0])
def test_compositing_and_equation_10(total):
    """The optical depth of the whole ray is `total`: half of the light is never lost, or is."""
    sigma = uniform(COUNT)
    sigma[::3] = 0
    sigma *= total / (STEP * sigma.sum())
    t = STEP * (torch.arange(COUNT) + 0.5)
    remaining, alpha, weight = (torch.empty(COUNT) for _ in range(3))
    median = torch.empty(1)
    arrays = [wp.from_torch(x) for x in (sigma, t, remaining, alpha, weight, median)]
    wp.launch(march, 1, [*arrays[:2], STEP, *arrays[2:]], device="cpu")
    expected = [transmittance(sigma[None], STEP)[0, 1:], opacities(sigma[None], STEP)[0]]
    expected += [render_weights(sigma[None], STEP)[0], median_depth(sigma[None], t[None], STEP)]
    for result, truth in zip((remaining, alpha, weight, median), expected, strict=True):
        torch.testing.assert_close(result, truth, **CLOSE)
    assert (median > 0) == (total > 0.7)


@wp.kernel
@no_type_check
def densities(
    values: wp.array(dtype=wp.float32),
    beta: wp.float32,
    sigma: wp.array(dtype=wp.float32),
    slope: wp.array(dtype=wp.float32),
):
    sigma[wp.tid()] = density_wp(beta, values[wp.tid()])
    slope[wp.tid()] = density_derivative_wp(beta, values[wp.tid()])


@pytest.mark.parametrize("beta", [0.0, 0.3])
def test_density_and_its_derivative(beta):
    values = (6 * uniform(COUNT) - 3).requires_grad_()
    sigma, slope = torch.empty(COUNT), torch.empty(COUNT)
    arrays = [wp.from_torch(x.detach()) for x in (values, sigma, slope)]
    wp.launch(densities, COUNT, [arrays[0], beta, *arrays[1:]], device="cpu")
    expected = density(values, beta)
    (expected_slope,) = torch.autograd.grad(expected.sum(), values)
    torch.testing.assert_close(sigma, expected.detach(), **CLOSE)
    torch.testing.assert_close(slope, expected_slope, **CLOSE)


@wp.kernel
@no_type_check
def confidences(
    agreement: wp.array(dtype=wp.float32),
    remaining: wp.array(dtype=wp.float32),
    weights: wp.array2d(dtype=wp.float32),
    largest: wp.array(dtype=wp.float32),
    alpha: wp.array(dtype=wp.float32),
    own: wp.bool,
    with_opacity: wp.bool,
    result: wp.array2d(dtype=wp.float32),
):
    i, j = wp.tid()
    result[i, j] = point_confidence_wp(
        agreement[i], remaining[i], weights[i, j], largest[i], 1.0 - alpha[i], own, with_opacity
    )


@pytest.mark.parametrize("reading", ["shared", "own"])
@pytest.mark.parametrize("opacity", ["with", "without"])
def test_equations_11_and_13(reading, opacity):
    agreement, remaining, alpha = uniform(3, COUNT)
    weights = uniform(COUNT, NEIGHBORS) + 0.01
    result = torch.empty(COUNT, NEIGHBORS)
    inputs = agreement, remaining, weights, weights.amax(dim=1), alpha
    arrays = [wp.from_torch(x.contiguous()) for x in (*inputs, result)]
    flags = [reading == "own", opacity == "with"]
    shape = COUNT, NEIGHBORS
    wp.launch(confidences, shape, [*arrays[:5], *flags, arrays[5]], device="cpu")
    voxel = voxel_confidence(remaining[:, None], weights[:, None], alpha[:, None], reading, opacity)
    torch.testing.assert_close(result, point_confidence(agreement, voxel)[:, 0], **CLOSE)


@wp.kernel
@no_type_check
def reductions(
    ids: wp.array(dtype=wp.int32),
    values: wp.array(dtype=wp.float32),
    is_sum: wp.bool,
    result: wp.array(dtype=wp.float32),
):
    reduce_sample_wp(result, ids[wp.tid()], values[wp.tid()], is_sum)


@pytest.mark.parametrize("reading", ["max", "sum"])
def test_samples_of_a_view_reduce_alike(reading):
    values = uniform(COUNT)
    ids = torch.arange(COUNT) ** 2 % 11  # 7 is no square: that point has no sample
    result = torch.zeros(11)
    arrays = [wp.from_torch(x) for x in (ids.int(), values, result)]
    wp.launch(reductions, COUNT, [*arrays[:2], reading == "sum", arrays[2]], device="cpu")
    assert result[7] == 0
    torch.testing.assert_close(result, reduce_samples(values, ids, 11, reading), **CLOSE)
