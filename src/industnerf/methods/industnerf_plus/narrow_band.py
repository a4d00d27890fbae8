"""Refinement of a surface: the points of the next level are in the cells beside it.

Light ends near a surface, so only the cells beside one are subdivided.  The visual hull is known
more finely than any grid; `SdfConstraints.initial_raw` cuts the finer distances by it, so grooves
between the coarser points appear.  Matter between them does not: nothing brings it back.
"""

import torch
from jaxtyping import Bool, Float32
from scipy.ndimage import distance_transform_edt
from torch import Tensor
from torch.nn.functional import grid_sample, max_pool3d

from industnerf.methods.industnerf.point_levels import (
    PointLevel,
    cell_indices,
    grid_mean,
    subdivide,
)

BAND_CELLS = 2  # cells on either side of a surface


def subdivide_narrow_band(
    points: Float32[Tensor, "m 3"],
    distance: Float32[Tensor, "m"],
    rgb: Float32[Tensor, "m 3"],
    spacing: float,
) -> PointLevel:
    """The cells beside the surface, subdivided in eight.

    Distances are trilinear between the old points; colors are those of the subdivided ones.
    """
    cells = round(2 / spacing)
    distances = densify(points, distance, cells)
    in_band = narrow_band_mask(distances, BAND_CELLS)
    x, y, z = cell_indices(points, cells).unbind(1)
    is_selected = in_band[x, y, z].nonzero()[:, 0]
    fine_points = subdivide(points[is_selected], spacing)
    colors = rgb[is_selected].repeat_interleave(8, dim=0)
    return PointLevel(fine_points, spacing / 2, (trilinear(distances, fine_points), colors))


def densify(
    points: Float32[Tensor, "m 3"], distance: Float32[Tensor, "m"], cells: int
) -> Float32[Tensor, "r r r"]:
    """Distances on all of [-1, 1]^3; an empty cell has that of the nearest cell with a point."""
    has_point = grid_mean(points, torch.ones_like(distance), cells) > 0
    _, nearest = distance_transform_edt(~has_point.cpu().numpy(), return_indices=True)
    x, y, z = torch.from_numpy(nearest).long().to(points.device)
    return grid_mean(points, distance, cells)[x, y, z]


def narrow_band_mask(distance: Float32[Tensor, "r r r"], radius: int) -> Bool[Tensor, "r r r"]:
    """Cells that have one of the other sign within `radius` cells."""
    solid = (distance < 0).float()[None]
    window = 2 * radius + 1
    has_sign_nearby = max_pool3d(torch.cat([solid, 1 - solid]), window, stride=1, padding=radius)
    return (has_sign_nearby > 0).all(dim=0)


def trilinear(
    values: Float32[Tensor, "r r r"], points: Float32[Tensor, "n 3"]
) -> Float32[Tensor, "n"]:
    """`values` at the cells' centers of [-1, 1]^3, trilinear between them."""
    sample_grid = points.flip(1)[None, None, None]  # grid_sample names the last axis first
    interpolated = grid_sample(
        values[None, None], sample_grid, padding_mode="border", align_corners=False
    )
    return interpolated[0, 0, 0, 0]
