"""Section 3.3, training losses: the photometric loss (R10), which is the paper's, and additions."""

import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.rendering.render import RenderOutput


def photometric_loss(
    output: RenderOutput, background: Float32[Tensor, "r 3"], target: Float32[Tensor, "r 3"]
) -> Float32[Tensor, ""]:
    """Mean squared error of the re-rendered pixels, composited over their background; R10."""
    return ((output.composite_over(background) - target) ** 2).mean()


def opacity_regularizer(
    output: RenderOutput, opacity_weight: float, binary_opacity_weight: float
) -> Float32[Tensor, ""] | float:
    """Penalties on opacity, and on opacity between 0 and 1.

    They settle what the images leave open: matter of the background's color outside the part, and
    thin black fog before a white background, which looks like gray.
    """
    if not (opacity_weight or binary_opacity_weight):
        return 0.0
    transmittance = output.transmittance
    opacity_loss = opacity_weight * (1 - transmittance).mean()
    return opacity_loss + binary_opacity_weight * (transmittance * (1 - transmittance)).mean()


def depth_loss(output: RenderOutput, measured_depth: Float32[Tensor, "r"]) -> Float32[Tensor, ""]:
    """Mean absolute error of the rendered depth; rays of measured depth 0 count as exact.

    Light that passes a measured surface counts as an error of 1, the radius of the unit ball.
    """
    error = (output.depth - measured_depth).abs()
    error = (1 - output.transmittance) * error + output.transmittance
    return torch.where(measured_depth > 0, error, 0.0).mean()
