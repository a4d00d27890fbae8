"""The Chamfer distance, with its gradient -- Groueix et al. (2018), equation (2), not squared."""

import torch
from jaxtyping import Float, Int
from torch import Tensor

SMOOTHING = 1e-3  # below this distance the gradient fades, or it would jump at 0; 1/16 of a pixel


def chamfer(a: Float[Tensor, "b n 3"], b: Float[Tensor, "b m 3"]) -> Float[Tensor, ""]:
    """Mean distance to the nearest point of the other cloud, the sum of both ways.

    Published is its square, whose gradient fades before patches lie on the surface.  Which point is
    nearest is found without a gradient: it changes by jumps.
    """
    if a.device.type == "cpu":
        # late: Warp is slow to import
        from industnerf.methods.atlasnet.nearest_kernel import nearest_compiled as nearest
    else:
        nearest = nearest_brute_force
    a_to_b, b_to_a = nearest(a.detach(), b.detach())
    return _mean_distance(a, b, a_to_b) + _mean_distance(b, a, b_to_a)


def _mean_distance(
    a: Float[Tensor, "b n 3"], b: Float[Tensor, "b m 3"], index: Int[Tensor, "b n"]
) -> Float[Tensor, ""]:
    nearest = b.gather(1, index[..., None].expand(-1, -1, 3))
    square = (a - nearest).square().sum(dim=2)
    return ((square + SMOOTHING**2).sqrt() - SMOOTHING).mean()


def nearest_brute_force(
    a: Float[Tensor, "b n 3"], b: Float[Tensor, "b m 3"]
) -> tuple[Int[Tensor, "b n"], Int[Tensor, "b m"]]:
    """For each point of a cloud the nearest of the other's, for a GPU.

    By differences: the expanded square loses half of the digits."""
    distances = torch.cdist(a, b, compute_mode="donot_use_mm_for_euclid_dist")
    return distances.argmin(dim=2), distances.argmin(dim=1)
