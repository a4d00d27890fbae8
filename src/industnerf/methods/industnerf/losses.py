"""What a step asks of the rays that it looked at: the error of their pixels, which is the paper's.

The others are additions, and 0 where their weight is.
"""

import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.rendering.render import RenderOutput


def photometric_loss(
    output: RenderOutput, background: Float32[Tensor, "r 3"], target: Float32[Tensor, "r 3"]
) -> Float32[Tensor, ""]:
    """Mean squared error of the re-rendered pixels before their background, R10."""
    return ((output.composite_over(background) - target) ** 2).mean()


def opacity_regularizer(
    output: RenderOutput, opacity_weight: float, binary_opacity_weight: float
) -> Float32[Tensor, ""] | float:
    """Of fields that re-render alike, rather the emptier one, and the one without veils.

    Matter of the background's color anywhere outside the part is as good as none; a thin
    veil of black before a white background is as good as gray.
    """
    if not (opacity_weight or binary_opacity_weight):
        return 0.0
    opacity_loss = opacity_weight * (1 - output.transmittance).mean()
    return (
        opacity_loss
        + binary_opacity_weight * (output.transmittance * (1 - output.transmittance)).mean()
    )


def depth_loss(
    output: RenderOutput, measured_depth: Float32[Tensor, "r"] | None, weight: float
) -> Float32[Tensor, ""] | float:
    """How far what is seen is from the readings of depth, if there are any; 0 is no reading.

    Light that passes where there is a surface counts as a radius of the region of interest.
    """
    if measured_depth is None:
        return 0.0
    depth_error = (1 - output.transmittance) * (
        output.depth - measured_depth
    ).abs() + output.transmittance
    return weight * torch.where(measured_depth > 0, depth_error, 0.0).mean()
