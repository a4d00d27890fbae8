"""A surface on a grid twice as fine, for `industnerf_plus`: what the next level starts from.

Light ends near a surface, so only the cells beside one are divided; the finer points hold what
lies between the coarser ones.  The hull is known more finely than any grid: `Relief.within` cuts
the finer points by it, and grooves that fell between the coarser ones are there.  Matter that fell
between them is not: nothing brings it back.

An addition to the paper, whose finer points are drawn (3.2).
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
    """The points beside the surface, in eight each.

    Distances are linear between the points, as the renderer has them; colors are those of the
    points that were divided.
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
    """Distances on all of [-1, 1]^3; a cell without a point has that of the nearest with one."""
    has_point = grid_mean(points, torch.ones_like(distance), cells) > 0
    _, nearest = distance_transform_edt(~has_point.cpu().numpy(), return_indices=True)
    x, y, z = torch.from_numpy(nearest).long().to(points.device)
    return grid_mean(points, distance, cells)[x, y, z]


def narrow_band_mask(distance: Float32[Tensor, "r r r"], radius: int) -> Bool[Tensor, "r r r"]:
    """Cells with one of the other sign among those that are up to `reach` from them."""
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
