"""The first solid: how deep every cell of the lattice is in the visual hull."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32, Int32

from industnerf.geometry.cameras import Cameras, framed_ball, projections_from_ball
from industnerf.geometry.cellwise import handed, told
from industnerf.geometry.silhouettes import TOUCHED

HALVINGS = 3  # from the first lattice, whose cells are all measured, to the last
# A child's centre is sqrt(3)/2 of its sides from its parent's, and a value counts within
# 1 of the surface; the rest is for distances in images, which perspective stretches.
NEAR = 2.5
UNKNOWN = np.float32(-1e6)  # the gap of a cell that too few views see


@dataclass(frozen=True)
class Rig:
    """The cameras in the unit frame."""

    projection: Float32[np.ndarray, "n 3 4"]
    eyes: Float32[np.ndarray, "n 3"]
    focal: Float32[np.ndarray, "n"]  # px
    centre: Float[np.ndarray, "3"]  # of the region of interest, mm
    radius_mm: float

    @property
    def px_across(self) -> float:
        """How many pixels span the region of interest where it is smallest."""
        return float((2 * self.focal / np.linalg.norm(self.eyes, axis=1)).min())


def rig_of(cameras: Cameras) -> Rig:
    """Cameras about the ball that all of them have in frame."""
    return rig_about(cameras, *framed_ball(cameras))


def rig_about(cameras: Cameras, centre: Float[np.ndarray, "3"], radius_mm: float) -> Rig:
    """Cameras about the ball that is given."""
    return Rig(
        projections_from_ball(cameras, centre, radius_mm),
        ((cameras.eyes - centre) / radius_mm).astype(np.float32),
        cameras.K[:, [0, 1], [0, 1]].max(axis=1).astype(np.float32),
        centre,
        radius_mm,
    )


def depth_in_hull(
    distance: Float32[np.ndarray, "n h w"], rig: Rig, grid_res: int
) -> Float32[np.ndarray, "r r r"]:
    """Signed distance (cells, positive inside) from the hull of pixels that the part touches.

    Exact near the surface alone; elsewhere of the right sign.
    """
    distance = distance - np.float32(TOUCHED)
    side = grid_res >> HALVINGS
    every = np.arange(side**3, dtype=np.int32)
    depth = measured(every, side, distance, rig).reshape((side,) * 3)
    while side < grid_res:
        side *= 2
        depth = 2 * depth.repeat(2, 0).repeat(2, 1).repeat(2, 2)
        near = np.flatnonzero(np.abs(depth) < NEAR).astype(np.int32)
        depth.ravel()[near] = measured(near, side, distance, rig)
    return depth


def measured(
    cells: Int32[np.ndarray, "m"], side: int, distance: Float32[np.ndarray, "n h w"], rig: Rig
) -> Float32[np.ndarray, "m"]:
    """The depth of `cells` of a lattice of `side`^3."""
    import warp as wp

    from industnerf.photohull import kernels

    inputs = [
        side,
        handed(distance, wp.float32),
        handed(rig.projection, kernels.mat34),
        handed(rig.focal, wp.float32),
    ]
    return told(kernels.measure_depth, cells, *inputs)
