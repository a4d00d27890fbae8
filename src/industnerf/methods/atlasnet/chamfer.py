"""The Chamfer distance, with its gradient -- Groueix et al. (2018), equation (2)."""

import numpy as np
import torch
from jaxtyping import Float, Int
from scipy.spatial import cKDTree
from torch import Tensor


def chamfer(a: Float[Tensor, "b n 3"], b: Float[Tensor, "b m 3"]) -> Float[Tensor, ""]:
    """Mean squared distance to the nearest point of the other cloud, the sum of both ways.

    Which point is nearest is found without a gradient: it changes by jumps.
    """
    find = nearest_by_trees if a.device.type == "cpu" else nearest_by_distances
    there, back = find(a.detach(), b.detach())
    return _apart(a, b, there) + _apart(b, a, back)


def _apart(
    a: Float[Tensor, "b n 3"], b: Float[Tensor, "b m 3"], which: Int[Tensor, "b n"]
) -> Float[Tensor, ""]:
    met = b.gather(1, which[..., None].expand(-1, -1, 3))
    return (a - met).square().sum(dim=2).mean()


def nearest_by_trees(
    a: Float[Tensor, "b n 3"], b: Float[Tensor, "b m 3"]
) -> tuple[Int[Tensor, "b n"], Int[Tensor, "b m"]]:
    """For each point of a cloud the nearest of the other's.

    On one core, with 16 pairs of clouds of 1000 points, twice as fast as all distances (52 ms
    against 120), with 8 pairs of 2500 points eight times.
    """
    trees = [[cKDTree(cloud) for cloud in clouds.numpy()] for clouds in (a, b)]
    pairs = list(zip(*trees, strict=True))
    there = np.stack([mine.query(other.data)[1] for other, mine in pairs])
    back = np.stack([other.query(mine.data)[1] for other, mine in pairs])
    return torch.from_numpy(there), torch.from_numpy(back)


def nearest_by_distances(
    a: Float[Tensor, "b n 3"], b: Float[Tensor, "b m 3"]
) -> tuple[Int[Tensor, "b n"], Int[Tensor, "b m"]]:
    """The same, for a GPU, by differences: the expanded square loses half of the digits."""
    distances = torch.cdist(a, b, compute_mode="donot_use_mm_for_euclid_dist")
    return distances.argmin(dim=2), distances.argmin(dim=1)
