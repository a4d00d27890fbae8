"""How far outside the photo hull points are: where `industnerf_plus` starts, an addition."""

from dataclasses import replace

import numpy as np
import torch
from edt import edt
from jaxtyping import Bool, Float32
from scipy.ndimage import map_coordinates
from torch import Tensor

from industnerf.geometry.silhouettes import differs
from industnerf.methods.industnerf.carving import TOLERANCE
from industnerf.methods.industnerf.scene import Posed, Scene
from industnerf.photohull import Carved, carved
from industnerf.photohull.lattice import rig_about
from industnerf.schema import SpaceCarvingSettings


class PhotoHull:
    """What the photographs leave of the hull; the hull itself, where they are not believed."""

    def __init__(self, posed: Posed, scene: Scene, ways: SpaceCarvingSettings) -> None:
        mask = differs(posed.rgb, scene.background.cpu().numpy(), TOLERANCE)
        rig = rig_about(posed.cameras, posed.centre, posed.radius)
        cells = carved(mask, posed.rgb, rig, of_two_pixels(ways, posed.rgb.shape[2]))
        self.believed, self.remarks = cells.believed, remarks(cells, ways.least_filled)
        left = depth_in(cells.left) if cells.left.any() else np.inf
        self._depth = np.minimum(cells.depth, left)

    def distance(self, points: Float32[Tensor, "m 3"]) -> Float32[Tensor, "m"]:
        """How far each point is outside, in the scene's unit; < 0 inside."""
        cell = 2 / len(self._depth)
        places = (points.cpu().numpy() + 1) / cell - 0.5
        depth = map_coordinates(self._depth, places.T, order=1, mode="nearest", prefilter=False)
        return torch.from_numpy(-depth * np.float32(cell)).to(points)


def remarks(cells: Carved, least: float) -> list[str]:
    """What is wrong with the photographs, a sentence each."""
    said = []
    if cells.hull_fills < least:
        said.append(
            f"the silhouettes contradict each other: their hull fills {cells.hull_fills:.0%} of "
            "them; are cameras inexact, is the background plain, does the part glint in its colour?"
        )
    if not cells.believed:
        said.append(
            "the photographs contradict the silhouettes: what is alike from all sides fills "
            f"{cells.rest_fills:.0%} of them (relief.start.least_filled), so the result stays "
            "nearer to the visual hull; does the part shine, did a light move, are cameras inexact?"
        )
    return said


def of_two_pixels(ways: SpaceCarvingSettings, width: int) -> SpaceCarvingSettings:
    """`ways` with cells of two pixels or more in images of this `width`.

    The colours within a pixel are averaged: of smaller cells each view would show another mean.
    """
    most = width // 2 - width // 2 % 8
    return replace(ways, grid_res=min(ways.grid_res, max(32, most)))


def depth_in(solid: Bool[np.ndarray, "r r r"]) -> Float32[np.ndarray, "r r r"]:
    """Signed distance (cells) of the cells' centres from the faces of `solid`, positive inside."""
    inside, outside = edt(solid), edt(~solid)
    return np.where(solid, inside - 0.5, 0.5 - outside).astype(np.float32)
