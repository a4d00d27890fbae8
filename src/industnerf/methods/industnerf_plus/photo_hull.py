"""Signed distance of points from the photo hull, which the surface starts at."""

from dataclasses import replace

import numpy as np
import torch
from jaxtyping import Bool, Float32
from scipy.ndimage import map_coordinates
from torch import Tensor

from industnerf.device import device
from industnerf.methods.industnerf.scene import PosedImages
from industnerf.methods.industnerf_plus.distance_transform import distance_transform
from industnerf.photohull import carve_space, carving_warnings
from industnerf.photohull.voxel_grid import unit_frame_cameras_about
from industnerf.schema import SpaceCarvingSettings

# Cells a side.  `CARVING_GRID_RES` of the schema has them too, but no schema is in a store key.
MIN_GRID_RES, GRID_RES_MULTIPLE = 32, 8


class PhotoHull:
    """The visual hull, carved by the photographs; the hull itself where these leave nothing."""

    def __init__(
        self,
        posed: PosedImages,
        outlines: Float32[np.ndarray, "n h w"],
        settings: SpaceCarvingSettings,
    ) -> None:
        rig = unit_frame_cameras_about(posed.cameras, posed.center, posed.radius)
        carving = carve_space(
            outlines, posed.rgb, rig, limit_grid_res(settings, rig.min_diameter_px)
        )
        self.is_reliable = carving.is_consistent and bool(carving.solid.any())
        self.warnings = carving_warnings(
            carving, settings, "the result stays nearer to the visual hull"
        )
        remaining_depth = signed_depth_grid(carving.solid) if carving.solid.any() else np.inf
        self._depth = np.minimum(carving.depth, remaining_depth)

    def distance(self, points: Float32[Tensor, "m 3"]) -> Float32[Tensor, "m"]:
        """Signed distance of each point, in the unit frame; < 0 inside.

        Deep inside it is too small in magnitude.
        """
        cell_size = 2 / len(self._depth)
        grid_coordinates = (points.cpu().numpy() + 1) / cell_size - 0.5
        depth = map_coordinates(
            self._depth, grid_coordinates.T, order=1, mode="nearest", prefilter=False
        )
        return torch.from_numpy(-depth * np.float32(cell_size)).to(points)


def limit_grid_res(settings: SpaceCarvingSettings, image_px: float) -> SpaceCarvingSettings:
    """`settings` with cells of at least two pixels; the region of interest is `image_px` wide.

    There are at least MIN_GRID_RES cells a side.  A pixel averages the colors within it, so of
    smaller cells each view would show another mean.
    """
    max_grid_res = int(image_px / 2) // GRID_RES_MULTIPLE * GRID_RES_MULTIPLE
    return replace(settings, grid_res=min(settings.grid_res, max(MIN_GRID_RES, max_grid_res)))


def signed_depth_grid(solid: Bool[np.ndarray, "r r r"]) -> Float32[np.ndarray, "r r r"]:
    """Signed distance (cells) of the cells' centers from the faces of `solid`, positive inside."""
    is_solid = torch.from_numpy(solid).to(device())
    distance_inside, distance_outside = distance_transform(torch.stack([~is_solid, is_solid]))
    return torch.where(is_solid, distance_inside - 0.5, 0.5 - distance_outside).cpu().numpy()
