"""The neural radiance points R of rays, and the cloud points around them -- paper, 3.3."""

from collections.abc import Callable
from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float, Int64
from torch import Tensor

from industnerf.rendering.neighbors import neighbors
from industnerf.rendering.sdf_density import density
from industnerf.rendering.weights import (
    InterpolationReading,
    inverse_distance_weights,
    trilinear_weights,
    weighted_mean,
)

MIN_DIRECTION = 1e-30  # stands for a direction's component of 0, so that no face is met at 0/0


@dataclass(frozen=True)
class Samples:
    """The radiance points of `r` rays, `s` each at most, with up to `k` neighbors each."""

    t: Float[Tensor, "r s"]  # along the ray; 0 where the ray has no such sample
    ids: Int64[Tensor, "r s k"]  # of cloud points; -1 = no neighbor
    weights: Float[Tensor, "r s k"]  # W of (11), not normalized

    def mean(self, values: Float[Tensor, "m c"]) -> Float[Tensor, "r s c"]:
        """The cloud's `values` interpolated at every sample; 0 where it has no neighbor."""
        rows = self.ids.flatten(0, 1), self.weights.flatten(0, 1)
        return weighted_mean(values, *rows).unflatten(0, self.t.shape)

    def sample_density(self, values: Float[Tensor, "r s"], beta: float) -> Float[Tensor, "r s"]:
        """The density where samples have these `values`; 0 where they have no neighbor."""
        return torch.where((self.ids >= 0).any(dim=2), density(values, beta), 0.0)


def radiance_points(
    origins: Float[Tensor, "r 3"],
    directions: Float[Tensor, "r 3"],
    offsets: Float[Tensor, "r"],
    lo: Float[Tensor, "3"],
    hi: Float[Tensor, "3"],
    points: Float[Tensor, "m 3"],
    *,
    step: float,
    radius: float,
    k: int,
    weights: InterpolationReading,
    is_occupied: Callable[[Tensor], Tensor] | None = None,
) -> Samples:
    """The samples of `sample_distances`, with the at most `k` nearest points within `radius`.

    Where positions are not `is_occupied`, samples have no neighbors.
    """
    t, inside = sample_distances(origins, directions, offsets, lo, hi, step)
    positions = (origins[:, None] + t[:, :, None] * directions[:, None]).flatten(0, 1)
    looks = inside.flatten()
    if is_occupied is not None:
        looks = looks & is_occupied(positions)
    ids = torch.full((len(looks), k), -1, device=looks.device)
    weight = positions.new_zeros(len(looks), k)
    ids[looks], weight[looks] = weighted_neighbors(positions[looks], points, radius, k, weights)
    return Samples(t, ids.unflatten(0, t.shape), weight.unflatten(0, t.shape))


def weighted_neighbors(
    positions: Float[Tensor, "q 3"],
    points: Float[Tensor, "m 3"],
    radius: float,
    k: int,
    weights: InterpolationReading,
) -> tuple[Int64[Tensor, "q {k}"], Float[Tensor, "q {k}"]]:
    """Ids of the neighbors of `positions`, -1 where there is none, and their weights, else 0.

    `trilinear` has its neighbors in a cube of half the side `radius`, the others in a ball.
    """
    if weights != "trilinear":
        ids, distance = neighbors(positions, points, radius, k)
        return ids, inverse_distance_weights(distance, radius, weights)
    ids, _ = neighbors(positions, points, radius, k, norm=torch.inf)
    if not len(points):
        return ids, torch.zeros_like(ids, dtype=points.dtype)
    weight = trilinear_weights(positions[:, None] - points[ids], radius)
    return ids, torch.where(ids >= 0, weight, 0)


def sample_distances(
    origins: Float[Tensor, "r 3"],
    directions: Float[Tensor, "r 3"],
    offsets: Float[Tensor, "r"],
    lo: Float[Tensor, "3"],
    hi: Float[Tensor, "3"],
    step: float,
) -> tuple[Float[Tensor, "r s"], Bool[Tensor, "r s"]]:
    """t_q = t_in + (q + offset) step for q = 0, 1, ..., and whether t_q < t_out; else t is 0.

    t_in = max(0, entry) and t_out = exit, by slabs; `offsets` in [0, 1), 0.5 = mid-step.
    """
    safe_directions = torch.where(directions == 0, MIN_DIRECTION, directions)
    slabs = torch.stack([(lo - origins) / safe_directions, (hi - origins) / safe_directions])
    t_in = slabs.amin(dim=0).amax(dim=1).clamp(min=0)
    t_out = slabs.amax(dim=0).amin(dim=1)
    max_length = max((t_out - t_in).tolist(), default=0.0)
    count = int(max(0.0, max_length) / step) + 2  # one to spare, lest rounding costs the last
    index = torch.arange(count, dtype=offsets.dtype, device=offsets.device)
    t = t_in[:, None] + (index + offsets[:, None]) * step
    inside = t < t_out[:, None]
    return t.where(inside, 0), inside
