"""From densities and colors along rays to pixels -- Max (1995); paper, eq. (10).

Samples follow each other from the eye at distances of `step`, so that s of them have s + 1
transmittances: before the first, between, and after the last.

Each formula stands here twice: over tensors of rays, and with the suffix `_wp` for one sample, as
`kernels.py` compiles it.  `tests/rendering/test_equations.py` holds the two together.
"""

from dataclasses import dataclass
from typing import no_type_check  # of what is compiled, there is nothing to check

import torch
import warp as wp
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
    """Eq. (10): T_i = exp(-sum_{j<i} sigma_j step), before each sample and after the last."""
    accumulated_density = torch.nn.functional.pad(sigma.cumsum(dim=1), (1, 0))
    return torch.exp(-step * accumulated_density)


@wp.func
@no_type_check
def sample_transmittance_wp(sigma: wp.float32, step: wp.float32):
    """Eq. (10), its factor of one sample: T_{i+1} = T_i exp(-sigma_i step)."""
    return wp.exp(-sigma * step)


def opacities(sigma: Float[Tensor, "r s"], step: float) -> Float[Tensor, "r s"]:
    """alpha = 1 - exp(-sigma step), to full precision for thin samples as well."""
    return -torch.expm1(-step * sigma)


@wp.func
@no_type_check
def opacity_wp(transmitted: wp.float32):
    """alpha of a sample that transmits this share of the light."""
    return 1.0 - transmitted


def render_weights(sigma: Float[Tensor, "r s"], step: float) -> Float[Tensor, "r s"]:
    """w_i = T_i alpha_i, by which a sample counts in the pixel."""
    return transmittance(sigma, step)[:, :-1] * opacities(sigma, step)


@wp.func
@no_type_check
def render_weight_wp(T: wp.float32, alpha: wp.float32):
    """w_i = T_i alpha_i of one sample."""
    return T * alpha


def terminated_density(
    sigma: Float[Tensor, "r s"], step: float, early_stop_transmittance: float
) -> Float[Tensor, "r s"]:
    """`sigma`, but 0 beyond the sample that leaves less than this share of the light."""
    return sigma * (transmittance(sigma, step)[:, :-1] >= early_stop_transmittance)


def composite(
    sigma: Float[Tensor, "r s"],
    rgb: Float[Tensor, "r s 3"],
    t: Float[Tensor, "r s"],
    background: Float[Tensor, "r 3"],
    step: float,
) -> CompositeOutput:
    """sum_i T_i alpha_i c_i + T_end background, and likewise for the distances `t`."""
    weights, T_end = render_weights(sigma, step), transmittance(sigma, step)[:, -1]
    pixel = (weights[:, :, None] * rgb).sum(dim=1) + T_end[:, None] * background
    opacity = 1 - T_end
    depth = (weights * t).sum(dim=1) / opacity.clamp(min=MIN_OPACITY)
    return CompositeOutput(pixel, opacity, depth)


def median_depth(
    sigma: Float[Tensor, "r s"], t: Float[Tensor, "r s"], step: float
) -> Float[Tensor, "r"]:
    """Where T falls through 1/2, each sample being as dense all along its step; -1 if nowhere."""
    remaining = transmittance(sigma, step)
    crosses = (remaining[:, :-1] >= 0.5) & (remaining[:, 1:] < 0.5)
    before = (2 * remaining[:, :-1]).log() / (sigma * step).where(crosses, 1)
    return torch.where(crosses, t + (before - 0.5) * step, -1).amax(dim=1)


@wp.func
@no_type_check
def median_depth_wp(
    median: wp.float32, T: wp.float32, sigma: wp.float32, t: wp.float32, step: wp.float32
):
    """`median` if it is found already, else where T falls through 1/2 in the sample at `t`; -1."""
    if median < 0.0 and T * sample_transmittance_wp(sigma, step) < 0.5:
        return t + (wp.log(2.0 * T) / (sigma * step) - 0.5) * step
    return median
