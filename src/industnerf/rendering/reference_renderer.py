"""The renderer written to be read: plain torch, brute force, any dtype.

The compiled kernels answer to it.  Torch itself differentiates it in densities, colors and
background; positions are constants.
"""

import torch
from jaxtyping import Float
from torch import Tensor

from industnerf.rendering.compositing import (
    CompositeOutput,
    composite,
    opacities,
    terminated_density,
)
from industnerf.rendering.compositing import transmittance as light_left
from industnerf.rendering.confidence import point_confidence, reduce_samples, voxel_confidence
from industnerf.rendering.samples import radiance_points
from industnerf.schema.readings import (
    InterpolationReading,
    OpacityReading,
    SampleReductionReading,
    TransmittanceReading,
)


def render_reference(
    origins: Float[Tensor, "r 3"],
    directions: Float[Tensor, "r 3"],
    offsets: Float[Tensor, "r"],
    lo: Float[Tensor, "3"],
    hi: Float[Tensor, "3"],
    points: Float[Tensor, "m 3"],
    values: Float[Tensor, "m"],
    rgb: Float[Tensor, "m 3"],
    background: Float[Tensor, "r 3"],
    *,
    step: float,
    radius: float,
    k: int,
    weights: InterpolationReading,
    early_stop_transmittance: float,
    beta: float = 0.0,
) -> CompositeOutput:
    """The cloud as the rays see it -- paper, 3.3.

    A radiance point takes the weighted mean value and color of its neighbors; a ray ends at
    the sample that leaves less than `stop` of its light (0 = never).  Values are densities, or
    where `beta` is above 0 signed distances.
    """
    samples = radiance_points(
        origins, directions, offsets, lo, hi, points, step=step, radius=radius, k=k, weights=weights
    )
    field = samples.mean(torch.cat([values[:, None], rgb], dim=1))
    sigma = terminated_density(
        samples.sample_density(field[..., 0], beta), step, early_stop_transmittance
    )
    return composite(sigma, field[..., 1:], samples.t, background, step)


def confidence_reference(
    origins: Float[Tensor, "r 3"],
    directions: Float[Tensor, "r 3"],
    offsets: Float[Tensor, "r"],
    lo: Float[Tensor, "3"],
    hi: Float[Tensor, "3"],
    points: Float[Tensor, "m 3"],
    values: Float[Tensor, "m"],
    agreement: Float[Tensor, "r"],
    *,
    step: float,
    radius: float,
    k: int,
    weights: InterpolationReading,
    early_stop_transmittance: float,
    beta: float = 0.0,
    transmittance: TransmittanceReading,
    opacity: OpacityReading,
    samples: SampleReductionReading,
) -> Float[Tensor, "m"]:
    """t of (13) for every cloud point: S T_i W_ij / max_j W_ij over all samples of all rays.

    S is the ray's `agreement` (12).  R9 and R15 are those of `voxel_confidence`, R16 is that of
    `reduce_samples`.  Samples beyond a ray's end give nothing; a point that is no sample's
    neighbor has 0.
    """
    ray_samples = radiance_points(
        origins, directions, offsets, lo, hi, points, step=step, radius=radius, k=k, weights=weights
    )
    sigma = ray_samples.sample_density(ray_samples.mean(values[:, None])[..., 0], beta)
    before = light_left(sigma, step)[:, :-1]
    voxel = voxel_confidence(
        before * (before >= early_stop_transmittance),
        ray_samples.weights,
        opacities(sigma, step),
        transmittance,
        opacity,
    )
    contributions = point_confidence(agreement, voxel)
    return reduce_samples(contributions.flatten(), ray_samples.ids.flatten(), len(points), samples)
