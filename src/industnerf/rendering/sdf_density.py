"""Density of a signed distance: an addition to the paper, after VolSDF -- Yariv et al. (2021).

Points may hold how far the surface is (> 0 outside, < 0 inside) instead of a density.  The forms
with the suffix `_wp` are those that `kernels.py` compiles; `density_derivative_wp` is their
derivative, written by hand.
"""

import math
from typing import no_type_check  # of what is compiled, there is nothing to check

import torch
import warp as wp
from jaxtyping import Float
from torch import Tensor

CUTOFF_BETAS = 6.0  # in beta: farther outside nothing is dense, so that empty space can be skipped
SIGMOID_CUTOFF = 1 / (1 + math.exp(CUTOFF_BETAS))  # the logistic function at -CUTOFF_BETAS

CUTOFF = wp.constant(SIGMOID_CUTOFF)
EXPONENT_LIMIT = wp.constant(50.0)


def sdf_to_density(distance: Float[Tensor, "*any"], beta: float) -> Float[Tensor, "*any"]:
    """max(0, (S(-distance / beta) - S(-CUTOFF_BETAS)) / beta), S the logistic function.

    The factor 1 / beta is what leaves half of the light where a plane has distance 0, whatever
    beta: (1 / beta) int_0^inf S(-x / beta) dx = ln 2.  VolSDF has Laplace's distribution for S.
    """
    return (torch.sigmoid(-distance / beta) - SIGMOID_CUTOFF).clamp(min=0) / beta


def density(values: Float[Tensor, "*any"], beta: float) -> Float[Tensor, "*any"]:
    """The density of what points hold: itself if `beta` is 0, else that of a distance."""
    return sdf_to_density(values, beta) if beta else values


@wp.func
@no_type_check
def sigmoid_wp(beta: wp.float32, value: wp.float32):
    """S(-value / beta); kept from overflow, which fast math forbids."""
    return 1.0 / (1.0 + wp.exp(wp.min(value / beta, EXPONENT_LIMIT)))


@wp.func
@no_type_check
def density_wp(beta: wp.float32, value: wp.float32):
    """`density` of one value."""
    if beta == 0.0:
        return value
    return wp.max(sigmoid_wp(beta, value) - CUTOFF, 0.0) / beta


@wp.func
@no_type_check
def density_derivative_wp(beta: wp.float32, value: wp.float32):
    """d density / d value."""
    if beta == 0.0:
        return wp.float32(1.0)
    inside_share = sigmoid_wp(beta, value)
    if inside_share <= CUTOFF:
        return wp.float32(0.0)
    return -inside_share * (1.0 - inside_share) / (beta * beta)
