"""From densities and colors along rays to pixels -- Max (1995); paper, eq. (10).

Samples follow each other from the eye at distances of `step`, so that s of them have s + 1
transmittances: before the first, between, and after the last.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor

MIN_OPACITY = 1e-8  # opacity below which the depth fades to 0 instead of being amplified


@dataclass(frozen=True)
class CompositeOutput:
    """What `r` rays see."""

    rgb: Float[Tensor, "r 3"]  # in [0, 1] if the points and the background are
    opacity: Float[Tensor, "r"]  # in [0, 1]; 0 = the background alone
    depth: Float[Tensor, "r"]  # distance along the ray, averaged over what is not background


def transmittance(sigma: Float[Tensor, "r s"], step: float) -> Float[Tensor, "r s+1"]:
    """Share of the light that is left before each sample and after the last.

    T_i = exp(-sum_{j<i} sigma_j step), the paper's (10).
    """
    accumulated_density = torch.nn.functional.pad(sigma.cumsum(dim=1), (1, 0))
    return torch.exp(-step * accumulated_density)


def opacities(sigma: Float[Tensor, "r s"], step: float) -> Float[Tensor, "r s"]:
    """alpha = 1 - exp(-sigma step), to full precision for thin samples as well."""
    return -torch.expm1(-step * sigma)


def terminated_density(
    sigma: Float[Tensor, "r s"], step: float, early_stop_transmittance: float
) -> Float[Tensor, "r s"]:
    """`sigma`, but 0 beyond the sample that leaves less than `stop` of the light."""
    return sigma * (transmittance(sigma, step)[:, :-1] >= early_stop_transmittance)


def composite(
    sigma: Float[Tensor, "r s"],
    rgb: Float[Tensor, "r s 3"],
    t: Float[Tensor, "r s"],
    background: Float[Tensor, "r 3"],
    step: float,
) -> CompositeOutput:
    """sum_i T_i alpha_i c_i + T_end background, and likewise for the distances `t`."""
    remaining = transmittance(sigma, step)
    weights = remaining[:, :-1] * opacities(sigma, step)
    pixel = (weights[:, :, None] * rgb).sum(dim=1) + remaining[:, -1:] * background
    opacity = 1 - remaining[:, -1]
    depth = (weights * t).sum(dim=1) / opacity.clamp(min=MIN_OPACITY)
    return CompositeOutput(pixel, opacity, depth)
