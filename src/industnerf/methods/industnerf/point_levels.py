"""Sections 3.1 and 3.2, levels of points: the initial grid X = S(r), and how cells divide.

All lengths are in the unit frame, where the region of interest is the unit ball.
"""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float32, Int64
from pykdtree.kdtree import KDTree
from torch import Tensor

from industnerf.methods.industnerf.density_pdf import inverse_transform_sample, latin_hypercube
from industnerf.schema import IndustnerfSettings, LevelSettings, WarmUpSettings
from industnerf.schema.readings import SamplePositionReading

WARM_UP = -1  # the level before the first: every eighth point of its grid


def level_name(level: int) -> str:
    """The level's name in messages and histories."""
    return "warm-up" if level == WARM_UP else f"level {level}"


def level_settings(settings: IndustnerfSettings, level: int) -> LevelSettings | WarmUpSettings:
    """The settings of a level, or of the warm-up."""
    return settings.warm_up if level == WARM_UP else settings.levels[level]


def grid_spacing(grid_res: int, level: int) -> float:
    """Distance of neighboring points of a grid on [-1, 1] that is halved at every level."""
    return 2 / (grid_res * 2**level)


@dataclass(frozen=True)
class PointLevel:
    """The points of a level, and what they take over from the last level."""

    points: Float32[Tensor, "m 3"]
    spacing: float  # distance of neighboring points
    residuals: tuple[Float32[Tensor, "m"], Float32[Tensor, "m 3"]] | None = None  # raw, rgb
    # (13) of the nearest point of the last level, view by view
    view_weights: Float32[Tensor, "v m"] | None = None

    def select(self, index: Bool[Tensor, "m"] | Int64[Tensor, "k"]) -> "PointLevel":
        """These of the points, in this order."""
        residuals, view_weights = self.residuals, self.view_weights
        return PointLevel(
            self.points[index],
            self.spacing,
            (residuals[0][index], residuals[1][index]) if residuals else None,
            None if view_weights is None else view_weights[:, index],
        )


def initial_grid(spacing: float, device: torch.device) -> Float32[Tensor, "m 3"]:
    """X = S(r): the centers of r^3 cells of [-1, 1]^3, r = 2 / spacing, that touch the unit ball.

    Every camera that aims at it has the ball in frame; what is beyond it some do not see.
    """
    axis = -1 + spacing * (torch.arange(round(2 / spacing), device=device) + 0.5)
    points = torch.cartesian_prod(axis, axis, axis)
    return points[points.norm(dim=1) < 1 + spacing]


def cell_indices(points: Float32[Tensor, "m 3"], cells: int) -> Int64[Tensor, "m 3"]:
    """Indices of the cells of [-1, 1]^3, `cells` a side, that the points are in."""
    return ((points + 1) * (cells / 2)).long().clamp(0, cells - 1)


def grid_mean(
    points: Float32[Tensor, "m 3"], values: Float32[Tensor, "m"], cells: int
) -> Float32[Tensor, "r r r"]:
    """The mean of `values` in every cell of [-1, 1]^3; 0 where there is no point."""
    cell = cell_indices(points, cells)
    flat_index = (cell[:, 0] * cells + cell[:, 1]) * cells + cell[:, 2]
    total = values.new_zeros(cells**3).scatter_reduce(
        0, flat_index, values, "mean", include_self=False
    )
    return total.reshape(cells, cells, cells)


def sample_points(
    density: Float32[Tensor, "r r r"],
    count: int,
    generator: torch.Generator,
    position: SamplePositionReading,
) -> Float32[Tensor, "n 3"]:
    """`count` points by inverse transform sampling of the density on a grid, eqs. (5)-(9)."""
    uniforms = latin_hypercube(count, generator).to(density.device)
    cell_positions = inverse_transform_sample(density, uniforms, position)
    return (cell_positions * (2 / len(density)) - 1).float()


def subdivide(points: Float32[Tensor, "m 3"], spacing: float) -> Float32[Tensor, "n 3"]:
    """Every point replaced by the centers of the eight halves of its cell of side `spacing`."""
    offsets = torch.tensor([-0.25, 0.25], device=points.device) * spacing
    return (points[:, None] + torch.cartesian_prod(offsets, offsets, offsets)).reshape(-1, 3)


def within_radius(
    points: Float32[Tensor, "m 3"], mask: Bool[Tensor, "m"], radius: float
) -> Bool[Tensor, "m"]:
    """Which points have one of those in `mask` within `radius`."""
    if not mask.any():
        return mask
    positions = points.double().cpu().numpy()
    tree = KDTree(positions[mask.cpu().numpy()])
    distances, _ = tree.query(positions, distance_upper_bound=radius)
    return torch.from_numpy(np.isfinite(distances)).to(points.device)
