"""How sure a cloud point is, from re-rendering the source views: eqs. (11)-(13).

A ray has s radiance points (samples), each with its k neighbors in the cloud; slots without a
neighbor have weight 0.  Any number of rays may lead the shapes.  Readings R8, R9, R15 and R16.

(11), (13) and R16 stand here twice: over tensors of rays, and with the suffix `_wp` for one
neighbor of one sample, as `kernels.accumulate_confidence` compiles it.
`tests/rendering/test_equations.py` holds the two together.
"""

import math
from typing import assert_never, no_type_check

import torch
import warp as wp
from jaxtyping import Float, Int64
from torch import Tensor

from industnerf.rendering.compositing import opacity_wp
from industnerf.schema.readings import (
    ColorScaleReading,
    OpacityReading,
    SampleReductionReading,
    TransmittanceReading,
)


def voxel_confidence(
    transmittance: Float[Tensor, "*rays s"],
    weights: Float[Tensor, "*rays s k"],
    alpha: Float[Tensor, "*rays s"],
    reading: TransmittanceReading,
    opacity: OpacityReading,
) -> Float[Tensor, "*rays s k"]:
    """Eq. (11): T_i W_i^j / max(W_i), in [0, 1]; 0 for slots without a neighbor.

    `transmittance` is T_i of eq. (10), in front of sample i; `alpha` the sample's own opacity.
    shared: T_i.  own: T_i (1 - alpha_i), what is left behind the sample.
    opacity with: times alpha_i.  Without it a faint point in front of the surface is sure.
    """
    visibility = _read_transmittance(transmittance, alpha, reading)
    if opacity == "with":
        visibility = visibility * alpha
    largest = weights.amax(dim=-1, keepdim=True)
    return visibility[..., None] * torch.where(largest > 0, weights / largest, 0)


def _read_transmittance(
    transmittance: Float[Tensor, "*rays s"],
    alpha: Float[Tensor, "*rays s"],
    reading: TransmittanceReading,
) -> Float[Tensor, "*rays s"]:
    match reading:
        case "shared":
            return transmittance
        case "own":
            return transmittance * (1 - alpha)
        case _:
            assert_never(reading)


def color_scale(reading: ColorScaleReading, contrast: float) -> float:
    """L of eq. (12), which the paper does not give, in units of RGB in [0, 1].

    max: sqrt(3), the largest distance of two colors, so that S > 0 unless black is rendered
    white.  unit: 1.  contrast: the spread of the colors looked at, of the background beside the
    part too, which the caller measures.
    """
    match reading:
        case "max":
            return math.sqrt(3)
        case "unit":
            return 1.0
        case "contrast":
            return contrast
        case _:
            assert_never(reading)


def color_confidence(
    observed: Float[Tensor, "n 3"], rendered: Float[Tensor, "n 3"], scale: float
) -> Float[Tensor, "n"]:
    """Eq. (12): S_i = max(1 - |I_i - O_i| / L, 0) of pixels, with `scale` L."""
    return (1 - (observed - rendered).norm(dim=-1) / scale).clamp(min=0)


def point_confidence(
    agreement: Float[Tensor, "*rays"], voxel: Float[Tensor, "*rays s k"]
) -> Float[Tensor, "*rays s k"]:
    """Eq. (13): S of the ray's pixel times (11) of its samples and their neighbors."""
    return agreement[..., None, None] * voxel


@wp.func
@no_type_check
def point_confidence_wp(
    agreement: wp.float32,
    transmittance: wp.float32,
    weight: wp.float32,
    max_weight: wp.float32,
    transmitted: wp.float32,
    own_transmittance: wp.bool,
    with_opacity: wp.bool,
):
    """Eqs. (13) and (11) of one neighbor of one sample: S T_i W_ij / max_j W_ij.

    The sample transmits the share 1 - alpha; flags stand for R9 `own` and R15 `with`.
    """
    confidence = agreement * transmittance / max_weight
    if own_transmittance:
        confidence = confidence * transmitted
    if with_opacity:
        confidence = confidence * opacity_wp(transmitted)
    return confidence * weight


def reduce_samples(
    values: Float[Tensor, "m"],
    ids: Int64[Tensor, "m"],
    n_points: int,
    reading: SampleReductionReading,
) -> Float[Tensor, "n"]:
    """One value a point from the many samples of one view; 0 for a point that no sample has.

    `ids` say which point a value is of; a negative one is of none.  A sum may exceed 1.
    """
    has_point = ids >= 0
    reduction = {"max": "amax", "sum": "sum"}[reading]
    return values.new_zeros(n_points).scatter_reduce(
        0, ids[has_point], values[has_point], reduction, include_self=False
    )


@wp.func
@no_type_check
def reduce_sample_wp(
    confidence: wp.array(dtype=wp.float32), point: wp.int32, value: wp.float32, is_sum: wp.bool
):
    """`reduce_samples`, one value at a time, into what the point has so far."""
    if is_sum:
        wp.atomic_add(confidence, point, value)
    else:
        wp.atomic_max(confidence, point, value)


def max_over_views(
    per_view: Float[Tensor, "v n"],
) -> tuple[Float[Tensor, "n"], Int64[Tensor, "n"]]:
    """The maximum over the views, and the first view that has it; -1 where all are 0."""
    confidence, view = per_view.max(dim=0)
    return confidence, view.masked_fill(confidence <= 0, -1)
