"""The visual hull on a cubic grid: the depth of every cell in it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32, Int32

from industnerf.geometry.cameras import Cameras, common_view_ball, unit_ball_projections
from industnerf.geometry.silhouettes import BOUNDARY_OFFSET_PX
from industnerf.geometry.warp_launch import launch, to_warp

SUBDIVISIONS = 3  # from the first grid, whose cells are all measured, to the last
# A child's center is sqrt(3)/2 of its sides from its parent's, and a value counts within
# 1 of the surface; the rest is for distances in images, which perspective stretches.
NARROW_BAND = 2.5
UNKNOWN = np.float32(-1e6)  # the gap of a cell that too few views see


@dataclass(frozen=True)
class UnitFrameCameras:
    """The cameras in the frame where the region of interest is the unit ball."""

    projection: Float32[np.ndarray, "n 3 4"]
    camera_centers: Float32[np.ndarray, "n 3"]
    focal: Float32[np.ndarray, "n"]  # px
    center: Float[np.ndarray, "3"]  # of the region of interest, mm
    radius_mm: float

    @property
    def min_diameter_px(self) -> float:
        """How many pixels span the region of interest in the view where it is smallest."""
        return float((2 * self.focal / np.linalg.norm(self.camera_centers, axis=1)).min())


def unit_frame_cameras(cameras: Cameras) -> UnitFrameCameras:
    """Cameras about the ball that all of them have in frame."""
    return unit_frame_cameras_about(cameras, *common_view_ball(cameras))


def unit_frame_cameras_about(
    cameras: Cameras, center: Float[np.ndarray, "3"], radius_mm: float
) -> UnitFrameCameras:
    """Cameras about the ball that is given."""
    return UnitFrameCameras(
        unit_ball_projections(cameras, center, radius_mm),
        ((cameras.centers - center) / radius_mm).astype(np.float32),
        cameras.K[:, [0, 1], [0, 1]].max(axis=1).astype(np.float32),
        center,
        radius_mm,
    )


def depth_in_hull(
    distance: Float32[np.ndarray, "n h w"], rig: UnitFrameCameras, grid_res: int
) -> Float32[np.ndarray, "r r r"]:
    """Signed distance (cells, positive inside) from the hull of pixels that the part touches.

    Exact near the surface alone; elsewhere of the right sign.
    """
    distance = distance - np.float32(BOUNDARY_OFFSET_PX)
    side = grid_res >> SUBDIVISIONS
    all_cells = np.arange(side**3, dtype=np.int32)
    depth = measure_depth(all_cells, side, distance, rig).reshape((side,) * 3)
    while side < grid_res:
        side *= 2
        depth = 2 * depth.repeat(2, 0).repeat(2, 1).repeat(2, 2)
        narrow_band = np.flatnonzero(np.abs(depth) < NARROW_BAND).astype(np.int32)
        depth.ravel()[narrow_band] = measure_depth(narrow_band, side, distance, rig)
    return depth


def measure_depth(
    cells: Int32[np.ndarray, "m"],
    side: int,
    distance: Float32[np.ndarray, "n h w"],
    rig: UnitFrameCameras,
) -> Float32[np.ndarray, "m"]:
    """The depth of `cells` (flat indices) of a grid of `side`^3, in cells."""
    import warp as wp

    from industnerf.photohull import kernels

    inputs = [
        side,
        to_warp(distance, wp.float32),
        to_warp(rig.projection, kernels.mat34),
        to_warp(rig.focal, wp.float32),
    ]
    return launch(kernels.measure_depth, cells, *inputs)
