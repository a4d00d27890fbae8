"""How far outside the photo hull points are: where `industnerf_plus` starts, an addition."""

from dataclasses import replace

import numpy as np
import torch
from jaxtyping import Bool, Float32
from scipy.ndimage import map_coordinates
from torch import Tensor

from industnerf.device import device
from industnerf.methods.industnerf.distances import distance_transform
from industnerf.methods.industnerf.scene import Posed
from industnerf.photohull import carved, remarks
from industnerf.photohull.lattice import rig_about
from industnerf.schema import SpaceCarvingSettings

# Cells a side.  The schema's BLOCKS has them too, but no schema counts in a key of the store.
COARSEST, BLOCK = 32, 8


class PhotoHull:
    """What the photographs leave of the hull; the hull itself, where they are not believed or
    leave nothing.
    """

    def __init__(
        self, posed: Posed, outlines: Float32[np.ndarray, "n h w"], ways: SpaceCarvingSettings
    ) -> None:
        rig = rig_about(posed.cameras, posed.centre, posed.radius)
        cells = carved(outlines, posed.rgb, rig, of_two_pixels(ways, rig.px_across))
        self.believed = cells.believed and bool(cells.left.any())
        self.remarks = remarks(cells, ways, "the result stays nearer to the visual hull")
        left = depth_in(cells.left) if cells.left.any() else np.inf
        self._depth = np.minimum(cells.depth, left)

    def distance(self, points: Float32[Tensor, "m 3"]) -> Float32[Tensor, "m"]:
        """How far each point is outside, in the scene's unit; < 0 inside.

        What is deep inside is said to be too near to the surface: see `lattice.depth_in_hull`.
        """
        cell = 2 / len(self._depth)
        places = (points.cpu().numpy() + 1) / cell - 0.5
        depth = map_coordinates(self._depth, places.T, order=1, mode="nearest", prefilter=False)
        return torch.from_numpy(-depth * np.float32(cell)).to(points)


def of_two_pixels(ways: SpaceCarvingSettings, px: float) -> SpaceCarvingSettings:
    """`ways` with cells of two pixels or more, where `px` span the region of interest.

    But never fewer than COARSEST a side: below 64 px cells are smaller.  The colours within a
    pixel are averaged: of smaller cells each view would show another mean.
    """
    most = int(px / 2) // BLOCK * BLOCK
    return replace(ways, grid_res=min(ways.grid_res, max(COARSEST, most)))


def depth_in(solid: Bool[np.ndarray, "r r r"]) -> Float32[np.ndarray, "r r r"]:
    """Signed distance (cells) of the cells' centres from the faces of `solid`, positive inside."""
    known = torch.from_numpy(solid).to(device())
    inside, outside = distance_transform(torch.stack([~known, known]))
    return torch.where(known, inside - 0.5, 0.5 - outside).cpu().numpy()
