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

from industnerf.methods.industnerf.levels import Layer, cells_of, divided, on_grid

REACH = 2  # cells on either side of a surface


def finer_surface(
    points: Float32[Tensor, "m 3"],
    distance: Float32[Tensor, "m"],
    rgb: Float32[Tensor, "m 3"],
    spacing: float,
) -> Layer:
    """The points beside the surface, in eight each.

    Distances are linear between the points, as the renderer has them; colours are those of the
    points that were divided.
    """
    cells = round(2 / spacing)
    distances = dense(points, distance, cells)
    beside = beside_surface(distances, REACH)
    x, y, z = cells_of(points, cells).unbind(1)
    chosen = beside[x, y, z].nonzero()[:, 0]
    fine = divided(points[chosen], spacing)
    colours = rgb[chosen].repeat_interleave(8, dim=0)
    return Layer(fine, spacing / 2, (linear(distances, fine), colours))


def dense(
    points: Float32[Tensor, "m 3"], distance: Float32[Tensor, "m"], cells: int
) -> Float32[Tensor, "r r r"]:
    """Distances on all of [-1, 1]^3; a cell without a point has that of the nearest with one."""
    held = on_grid(points, torch.ones_like(distance), cells) > 0
    _, nearest = distance_transform_edt(~held.cpu().numpy(), return_indices=True)
    x, y, z = torch.from_numpy(nearest).long().to(points.device)
    return on_grid(points, distance, cells)[x, y, z]


def beside_surface(distance: Float32[Tensor, "r r r"], reach: int) -> Bool[Tensor, "r r r"]:
    """Cells with one of the other sign among those that are up to `reach` from them."""
    solid = (distance < 0).float()[None]
    side = 2 * reach + 1
    near = max_pool3d(torch.cat([solid, 1 - solid]), side, stride=1, padding=reach)
    return (near > 0).all(dim=0)


def linear(
    values: Float32[Tensor, "r r r"], points: Float32[Tensor, "n 3"]
) -> Float32[Tensor, "n"]:
    """`values` at the cells' centres of [-1, 1]^3, trilinear between them."""
    where = points.flip(1)[None, None, None]  # grid_sample names the last axis first
    found = grid_sample(values[None, None], where, padding_mode="border", align_corners=False)
    return found[0, 0, 0, 0]
