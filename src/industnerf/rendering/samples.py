"""The neural radiance points R of rays, and the cloud points around them -- paper, 3.3."""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float, Int64
from torch import Tensor

from industnerf.rendering.distance import density
from industnerf.rendering.neighbours import neighbours
from industnerf.rendering.weights import (
    WeightReading,
    inverse_distance_weights,
    tent_weights,
    weighted_mean,
)

TILT = 1e-30  # stands for a direction's component of 0, so that no face is met at 0/0


@dataclass(frozen=True)
class Samples:
    """The radiance points of `r` rays, `s` each at most, with up to `k` neighbours each."""

    t: Float[Tensor, "r s"]  # along the ray; 0 where the ray has no such sample
    ids: Int64[Tensor, "r s k"]  # of cloud points; -1 = no neighbour
    weights: Float[Tensor, "r s k"]  # W of (11), not normalised

    def mean(self, values: Float[Tensor, "m c"]) -> Float[Tensor, "r s c"]:
        """The cloud's `values` interpolated at every sample; 0 where it has no neighbour."""
        rows = self.ids.flatten(0, 1), self.weights.flatten(0, 1)
        return weighted_mean(values, *rows).unflatten(0, self.t.shape)

    def dense(self, values: Float[Tensor, "r s"], beta: float) -> Float[Tensor, "r s"]:
        """The density where samples have these `values`; 0 where they have no neighbour."""
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
    weights: WeightReading,
) -> Samples:
    """What `rays_in_cube` samples, with the at most `k` nearest points nearer than `radius`."""
    t, inside = rays_in_cube(origins, directions, offsets, lo, hi, step)
    at = origins[:, None] + t[:, :, None] * directions[:, None]
    at = at.where(inside[:, :, None], torch.inf)  # out there nothing is a neighbour
    ids, weight = weighted_neighbours(at.flatten(0, 1), points, radius, k, weights)
    return Samples(t, ids.reshape(*t.shape, k), weight.reshape(*t.shape, k))


def weighted_neighbours(
    at: Float[Tensor, "q 3"],
    points: Float[Tensor, "m 3"],
    radius: float,
    k: int,
    weights: WeightReading,
) -> tuple[Int64[Tensor, "q {k}"], Float[Tensor, "q {k}"]]:
    """Ids of the neighbours of `at`, -1 where there is none, and their weights.

    `tent` has its neighbours in a cube of half the side `radius`, the others in a ball.
    """
    if weights != "tent":
        ids, distance = neighbours(at, points, radius, k)
        return ids, inverse_distance_weights(distance, radius, weights)
    ids, _ = neighbours(at, points, radius, k, norm=torch.inf)
    if not len(points):
        return ids, torch.zeros_like(ids, dtype=points.dtype)
    weight = tent_weights(at[:, None] - points[ids], radius)
    return ids, torch.where(ids >= 0, weight, 0)


def rays_in_cube(
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
    along = torch.where(directions == 0, TILT, directions)
    faces = torch.stack([(lo - origins) / along, (hi - origins) / along])
    t_in = faces.amin(dim=0).amax(dim=1).clamp(min=0)
    t_out = faces.amax(dim=0).amin(dim=1)
    longest = max((t_out - t_in).tolist(), default=0.0)
    count = int(max(0.0, longest) / step) + 2  # one to spare, lest rounding costs the last
    number = torch.arange(count, dtype=offsets.dtype, device=offsets.device)
    t = t_in[:, None] + (number + offsets[:, None]) * step
    inside = t < t_out[:, None]
    return t.where(inside, 0), inside
