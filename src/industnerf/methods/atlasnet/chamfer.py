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
    nearest = nearest_kdtree if a.device.type == "cpu" else nearest_brute_force
    a_to_b, b_to_a = nearest(a.detach(), b.detach())
    return _mean_squared_distance(a, b, a_to_b) + _mean_squared_distance(b, a, b_to_a)


def _mean_squared_distance(
    a: Float[Tensor, "b n 3"], b: Float[Tensor, "b m 3"], index: Int[Tensor, "b n"]
) -> Float[Tensor, ""]:
    nearest = b.gather(1, index[..., None].expand(-1, -1, 3))
    return (a - nearest).square().sum(dim=2).mean()


def nearest_kdtree(
    a: Float[Tensor, "b n 3"], b: Float[Tensor, "b m 3"]
) -> tuple[Int[Tensor, "b n"], Int[Tensor, "b m"]]:
    """For each point of a cloud the nearest of the other's.

    On one core, with 16 pairs of clouds of 1000 points, twice as fast as all distances (52 ms
    against 120), with 8 pairs of 2500 points eight times.
    """
    trees = [[cKDTree(cloud) for cloud in clouds.numpy()] for clouds in (a, b)]
    pairs = list(zip(*trees, strict=True))
    a_to_b = np.stack([tree_b.query(tree_a.data)[1] for tree_a, tree_b in pairs])
    b_to_a = np.stack([tree_a.query(tree_b.data)[1] for tree_a, tree_b in pairs])
    return torch.from_numpy(a_to_b), torch.from_numpy(b_to_a)


def nearest_brute_force(
    a: Float[Tensor, "b n 3"], b: Float[Tensor, "b m 3"]
) -> tuple[Int[Tensor, "b n"], Int[Tensor, "b m"]]:
    """The same, for a GPU, by differences: the expanded square loses half of the digits."""
    distances = torch.cdist(a, b, compute_mode="donot_use_mm_for_euclid_dist")
    return distances.argmin(dim=2), distances.argmin(dim=1)
