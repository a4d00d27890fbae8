"""From coarse to fine: the first grid (3.1), and the points that refine it (3.2)."""

import numpy as np
import torch
from jaxtyping import Bool, Float32, Int64
from scipy.spatial import cKDTree
from torch import Tensor

from industnerf.methods.industnerf.distribution import (
    density_to_sample,
    inverse_transform,
    stratified,
)
from industnerf.schema.readings import PlaceReading, TargetReading


def spacing_of(grid_res: int, level: int) -> float:
    """Distance of neighbouring points of a grid on [-1, 1] that is halved at every level."""
    return 2 / (grid_res * 2**level)


def grid(grid_res: int, device: torch.device) -> Float32[Tensor, "m 3"]:
    """X = S(r): the centres of r^3 cells of [-1, 1]^3, those that touch the unit ball.

    Every camera has the ball in frame; what is beyond it some cameras do not see.
    """
    spacing = spacing_of(grid_res, 0)
    axis = -1 + spacing * (torch.arange(grid_res, device=device) + 0.5)
    points = torch.cartesian_prod(axis, axis, axis)
    return points[points.norm(dim=1) < 1 + spacing]


def cells_of(points: Float32[Tensor, "m 3"], cells: int) -> Int64[Tensor, "m 3"]:
    """Indices of the cells of [-1, 1]^3, `cells` a side, that the points are in."""
    return ((points + 1) * (cells / 2)).long().clamp(0, cells - 1)


def on_grid(
    points: Float32[Tensor, "m 3"], values: Float32[Tensor, "m"], cells: int
) -> Float32[Tensor, "r r r"]:
    """The mean of `values` in every cell of [-1, 1]^3; 0 where there is no point."""
    index = cells_of(points, cells)
    flat = (index[:, 0] * cells + index[:, 1]) * cells + index[:, 2]
    total = values.new_zeros(cells**3).scatter_reduce(0, flat, values, "mean", include_self=False)
    return total.reshape(cells, cells, cells)


def sampled(
    points: Float32[Tensor, "m 3"],
    sigma: Float32[Tensor, "m"],
    visibility: Float32[Tensor, "m"],
    cells: int,
    count: int,
    generator: torch.Generator,
    target: TargetReading,
    place: PlaceReading,
) -> Float32[Tensor, "n 3"]:
    """`count` points by inverse transform sampling of the density, eqs. (5)-(9)."""
    density = density_to_sample(
        on_grid(points, sigma, cells), on_grid(points, visibility, cells), target
    )
    uniforms = stratified(count, generator).to(density.device)
    places = inverse_transform(density, uniforms, place)
    return (places * (2 / cells) - 1).float()


def divided(points: Float32[Tensor, "m 3"], spacing: float) -> Float32[Tensor, "n 3"]:
    """Every point replaced by the centres of the eight halves of its cell of side `spacing`."""
    side = torch.tensor([-0.25, 0.25], device=points.device) * spacing
    return (points[:, None] + torch.cartesian_prod(side, side, side)).reshape(-1, 3)


def near_any(
    points: Float32[Tensor, "m 3"], chosen: Bool[Tensor, "m"], reach: float
) -> Bool[Tensor, "m"]:
    """Which points have a chosen one within `reach`."""
    if not chosen.any():
        return chosen
    tree = cKDTree(points[chosen].cpu().numpy())
    away, _ = tree.query(points.cpu().numpy(), distance_upper_bound=reach)
    return torch.from_numpy(np.isfinite(away)).to(points.device)
