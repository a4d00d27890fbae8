"""How sure a cloud point is, from re-rendering the source views: eqs. (11)-(13).

A ray has s radiance points (samples), each with its k neighbors in the cloud; slots without a
neighbor have weight 0.  Any number of rays may lead the shapes.  Readings R8, R9, R15 and R16.

Reconstruction takes (11), (13) and R16 in one compiled pass, `kernels.confide`; here they stand to
be read, and as what that pass is tested against.
"""

import math
from typing import assert_never

import torch
from jaxtyping import Float, Int64
from torch import Tensor

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


def max_over_views(
    per_view: Float[Tensor, "v n"],
) -> tuple[Float[Tensor, "n"], Int64[Tensor, "n"]]:
    """The maximum over the views, and the first view that has it; -1 where all are 0."""
    confidence, view = per_view.max(dim=0)
    return confidence, view.masked_fill(confidence <= 0, -1)
