"""TSDF fusion of depth images.

Curless and Levoy, "A Volumetric Method for Building Complex Models from Range Images" (1996).
Unit frame: the region of interest is the ball of radius 1 about the origin, and the lattice
tiles the cube around it.  Depths and distances are in that unit, distances positive inside.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32
from scipy.ndimage import binary_dilation, minimum_filter

from industnerf.geometry.warp_launch import launch, to_warp

OUTLINE_PX = 3  # px; within this square about a pixel, the part may cover what its center does not
BACKGROUND_DEPTH = np.float32(1e6)  # of the background where slopes are measured: larger than any
UNKNOWN = np.float32(-1.0)  # depth of a pixel of which nothing is known


@dataclass(frozen=True)
class DepthImages:
    """Depth images, and what is read from them."""

    depth: Float32[np.ndarray, "n h w"]  # inf: background, -inf: nothing is known
    nearest: Float32[
        np.ndarray, "n h w"
    ]  # least depth in the square of OUTLINE_PX about each pixel
    cosine: Float32[np.ndarray, "n h w"]  # between ray and normal; 0 where no surface is seen
    projection: Float32[np.ndarray, "n 3 4"]

    def to_kernel_struct(self) -> Any:
        """The images as a Warp struct, on the device of the kernels."""
        import warp as wp

        from industnerf.geometry import tsdf_kernels

        images = tsdf_kernels.DepthImages()
        for name in ("depth", "nearest", "cosine"):
            setattr(images, name, to_warp(getattr(self, name), wp.float32))
        images.projection = to_warp(self.projection, tsdf_kernels.mat34)
        return images


def prepare_depth_images(
    depth: Float32[np.ndarray, "n h w"], projection: Float32[np.ndarray, "n 3 4"]
) -> DepthImages:
    """The images of `depth`, in which 0 is the background.

    Where it is UNKNOWN, and a pixel beside, an image says nothing of what is empty.
    """
    has_surface = depth > 0
    fallback_depth = np.where(depth < 0, np.float32(-np.inf), np.float32(np.inf))
    filled_depth, cosines = np.where(has_surface, depth, fallback_depth), np.zeros_like(depth)
    for out, *image in zip(cosines, depth, projection, strict=True):
        np.multiply(viewing_cosine(*image), image[0] > 0, out=out)
    return DepthImages(
        filled_depth, minimum_filter(filled_depth, (1, OUTLINE_PX, OUTLINE_PX)), cosines, projection
    )


def viewing_cosine(
    depth: Float32[np.ndarray, "h w"], projection: Float32[np.ndarray, "3 4"]
) -> Float32[np.ndarray, "h w"]:
    """Between the ray of each pixel and the normal of what it sees."""
    filled = np.where(depth > 0, depth, BACKGROUND_DEPTH)
    pixel_size = filled / focal_length(projection)  # what it spans
    return (1 / np.sqrt(1 + (depth_slopes(filled) / pixel_size) ** 2)).astype(np.float32)


def focal_length(projection: Float32[np.ndarray, "3 4"]) -> float:
    """Of u = (f x + c z) / z: the part of u's row that is across the axis, in px."""
    across = np.cross(projection[0, :3], projection[2, :3])
    return float(np.linalg.norm(across) / np.linalg.norm(projection[2, :3]) ** 2)


def depth_slopes(depth: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """How fast `depth` changes, per pixel: on the flatter side of each, for an edge ends one."""
    squared = np.zeros_like(depth)
    for along in (depth, depth.T):
        change = np.abs(
            np.diff(along, axis=0, prepend=2 * BACKGROUND_DEPTH, append=2 * BACKGROUND_DEPTH)
        )
        flatter = np.minimum(change[1:], change[:-1])
        squared += (flatter if along is depth else flatter.T) ** 2
    return np.sqrt(squared)


def fuse(
    depth: Float32[np.ndarray, "n h w"],
    projection: Float32[np.ndarray, "n 3 4"],
    grid_res: int,
    truncation: float,
) -> Float32[np.ndarray, "r r r"]:
    """Signed distance at the center of every cell: `truncation` where nothing is seen.

    What is seen empty, or lies beyond the ball, is outside; beside the rest it keeps its distance,
    or the surface would be drawn inwards by all views that look past it.  Images that show nothing
    say nothing.
    """
    from industnerf.geometry import tsdf_kernels

    has_surface = depth.any(axis=(1, 2))
    images = prepare_depth_images(depth[has_surface], projection[has_surface])
    args = grid_res, truncation, images.to_kernel_struct()
    all_cells = np.arange(grid_res**3, dtype=np.int32)
    is_unseen = launch(tsdf_kernels.measure_unseen, all_cells, *args) > 0
    solid = is_unseen.reshape((grid_res,) * 3)
    narrow_band = all_cells[binary_dilation(solid, np.ones((3, 3, 3), bool)).ravel()]
    mean = launch(tsdf_kernels.measure_mean, narrow_band, *args)
    values = np.full(len(all_cells), -truncation, np.float32)
    values[narrow_band] = np.where(
        is_unseen[narrow_band] | (mean < 0), mean, -np.float32(truncation)
    )
    values = values.reshape(solid.shape)
    values[_outside_unit_ball(grid_res)] = -truncation
    return values


def _outside_unit_ball(grid_res: int) -> Bool[np.ndarray, "r r r"]:
    """Which cells are not in the unit ball, which holds the part: views may not show them."""
    squares = ((np.arange(grid_res) + 0.5) * (2 / grid_res) - 1) ** 2
    return squares[:, None, None] + squares[:, None] + squares > 1
