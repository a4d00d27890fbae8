"""From coarse to fine: the first grid (3.1), and the points that refine it (3.2)."""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float32, Int64
from pykdtree.kdtree import KDTree
from torch import Tensor

from industnerf.methods.industnerf.distribution import inverse_transform, stratified
from industnerf.schema.readings import PlaceReading

WARM_UP = -1  # the level before the first: every eighth point of its grid


def name_of(level: int) -> str:
    """As people are told of it."""
    return "warm-up" if level == WARM_UP else f"level {level}"


def spacing_of(grid_res: int, level: int) -> float:
    """Distance of neighbouring points of a grid on [-1, 1] that is halved at every level."""
    return 2 / (grid_res * 2**level)


@dataclass(frozen=True)
class Layer:
    """The points of a level, how far apart they are, and what they take over from the last."""

    points: Float32[Tensor, "m 3"]
    spacing: float
    residuals: tuple[Float32[Tensor, "m"], Float32[Tensor, "m 3"]] | None = None
    trust: Float32[Tensor, "v m"] | None = None  # (13), as each view had it of the nearest point

    def only(self, which: Bool[Tensor, "m"] | Int64[Tensor, "k"]) -> "Layer":
        """These of the points, in this order."""
        residuals, trust = self.residuals, self.trust
        return Layer(
            self.points[which],
            self.spacing,
            (residuals[0][which], residuals[1][which]) if residuals else None,
            None if trust is None else trust[:, which],
        )


def grid(spacing: float, device: torch.device) -> Float32[Tensor, "m 3"]:
    """X = S(r): the centres of r^3 cells of [-1, 1]^3, r = 2 / spacing, that touch the unit ball.

    Every camera that aims at it has the ball in frame; what is beyond it some do not see.
    """
    axis = -1 + spacing * (torch.arange(round(2 / spacing), device=device) + 0.5)
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
    density: Float32[Tensor, "r r r"], count: int, generator: torch.Generator, place: PlaceReading
) -> Float32[Tensor, "n 3"]:
    """`count` points by inverse transform sampling of the density on a grid, eqs. (5)-(9)."""
    uniforms = stratified(count, generator).to(density.device)
    places = inverse_transform(density, uniforms, place)
    return (places * (2 / len(density)) - 1).float()


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
    places = points.double().cpu().numpy()
    tree = KDTree(places[chosen.cpu().numpy()])
    away, _ = tree.query(places, distance_upper_bound=reach)
    return torch.from_numpy(np.isfinite(away)).to(points.device)
