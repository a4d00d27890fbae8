"""Density of a signed distance: an addition to the paper, after VolSDF -- Yariv et al. (2021).

Points may hold how far the surface is (> 0 outside, < 0 inside) instead of a density.
"""

import math

import torch
from jaxtyping import Float
from torch import Tensor

CUTOFF_BETAS = (
    6.0  # in beta: from there on outside nothing is dense, that empty space can be skipped
)
SIGMOID_CUTOFF = 1 / (1 + math.exp(CUTOFF_BETAS))  # the logistic function at -REACH


def sdf_to_density(distance: Float[Tensor, "*any"], beta: float) -> Float[Tensor, "*any"]:
    """max(0, (S(-distance / beta) - S(-REACH)) / beta), S the logistic function.

    The factor 1 / beta is what leaves half of the light where a plane has distance 0, whatever
    beta: (1 / beta) int_0^inf S(-x / beta) dx = ln 2.  VolSDF has Laplace's distribution for S.
    """
    return (torch.sigmoid(-distance / beta) - SIGMOID_CUTOFF).clamp(min=0) / beta


def density(values: Float[Tensor, "*any"], beta: float) -> Float[Tensor, "*any"]:
    """The density of what points hold: itself if `beta` is 0, else that of a distance."""
    return sdf_to_density(values, beta) if beta else values
