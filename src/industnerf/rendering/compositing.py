"""From densities and colours along rays to pixels -- Max (1995); paper, eq. (10).

Samples follow each other from the eye at distances of `step`, so that s of them have s + 1
transmittances: before the first, between, and after the last.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor

FAINTEST = 1e-8  # opacity below which the depth fades to 0 instead of being amplified


@dataclass(frozen=True)
class Rendered:
    """What `r` rays see."""

    rgb: Float[Tensor, "r 3"]  # in [0, 1] if the points and the background are
    opacity: Float[Tensor, "r"]  # in [0, 1]; 0 = the background alone
    depth: Float[Tensor, "r"]  # distance along the ray, averaged over what is not background


def transmittance(sigma: Float[Tensor, "r s"], step: float) -> Float[Tensor, "r s+1"]:
    """Share of the light that is left before each sample and after the last.

    T_i = exp(-sum_{j<i} sigma_j step), the paper's (10).
    """
    passed = torch.nn.functional.pad(sigma.cumsum(dim=1), (1, 0))
    return torch.exp(-step * passed)


def opacities(sigma: Float[Tensor, "r s"], step: float) -> Float[Tensor, "r s"]:
    """alpha = 1 - exp(-sigma step), to full precision for thin samples as well."""
    return -torch.expm1(-step * sigma)


def stopped(sigma: Float[Tensor, "r s"], step: float, stop: float) -> Float[Tensor, "r s"]:
    """`sigma`, but 0 beyond the sample that leaves less than `stop` of the light."""
    return sigma * (transmittance(sigma, step)[:, :-1] >= stop)


def composite(
    sigma: Float[Tensor, "r s"],
    rgb: Float[Tensor, "r s 3"],
    t: Float[Tensor, "r s"],
    background: Float[Tensor, "r 3"],
    step: float,
) -> Rendered:
    """sum_i T_i alpha_i c_i + T_end background, and likewise for the distances `t`."""
    left = transmittance(sigma, step)
    weights = left[:, :-1] * opacities(sigma, step)
    pixel = (weights[:, :, None] * rgb).sum(dim=1) + left[:, -1:] * background
    opacity = 1 - left[:, -1]
    depth = (weights * t).sum(dim=1) / opacity.clamp(min=FAINTEST)
    return Rendered(pixel, opacity, depth)
