"""How much each neighbor counts at a radiance point: reading R7 of "inverse distance weighting".

A neighbor that is not there has id -1 and distance inf; it weighs nothing.
"""

import torch
from jaxtyping import Float, Int
from torch import Tensor

from industnerf.schema.readings import InterpolationReading

FLOOR = 1e-3  # of the radius: nearer points count as if they were so far, which bounds the weights


def inverse_distance_weights(
    distance: Float[Tensor, "*any"], radius: float, reading: InterpolationReading
) -> Float[Tensor, "*any"]:
    """W of (11): > 0 below `radius` and 0 from there on; not normalized.

    inverse         1 / distance
    inverse_square  1 / distance^2
    modified_shepard
                    ((radius - distance) / (radius distance))^2, which reaches 0 without a jump
                    -- Franke and Little, in Franke (1982), Scattered data interpolation

    Raises ValueError for `trilinear`, which takes more than a distance: `trilinear_weights`.
    """
    if reading == "trilinear":
        raise ValueError(
            "trilinear is no weight by distance alone: `trilinear_weights` takes the offsets"
        )
    is_near = distance < radius
    distance = torch.where(is_near, distance, radius)  # inf - inf is no number
    weight = 1 / distance.clamp(min=FLOOR * radius)
    if reading == "inverse_square":
        weight = weight**2
    if reading == "modified_shepard":
        weight = ((1 - distance / radius) * weight) ** 2
    return weight * is_near


def trilinear_weights(offsets: Float[Tensor, "*any 3"], radius: float) -> Float[Tensor, "*any"]:
    """The product over the axes of 1 - |apart| / radius, and 0 beyond; not normalized.

    On a grid of that spacing it is trilinear interpolation: linear fields come out as they are,
    which no weight by distance alone can do.
    """
    return (1 - offsets.abs() / radius).clamp(min=0).prod(dim=-1)


def weighted_mean(
    values: Float[Tensor, "m c"], ids: Int[Tensor, "q k"], weights: Float[Tensor, "q k"]
) -> Float[Tensor, "q c"]:
    """sum_j W_j v_j / sum_j W_j over each row's neighbors; 0 where it has none."""
    values = torch.cat([values, values.new_zeros(1, values.shape[1])])  # what id -1 stands for
    total = weights.sum(dim=1, keepdim=True)
    share = weights / torch.where(total > 0, total, 1)
    return (share[:, :, None] * values[ids]).sum(dim=1)
