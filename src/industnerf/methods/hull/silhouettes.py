"""Silhouettes as distance images, and how points in space are read from them.

Unit frame: the region of interest is the ball of radius 1 about the origin.  Distances in an
image are in px, positive inside the silhouette; (u, v) count from the first pixel's center, so
they are half a pixel less than the suite's, and whole numbers are pixel centers.

All is float32: a coordinate below 4096 px is known to 1/4000 px, a position in the unit frame
to 1e-7, where the smallest cell in use is some 1e-4.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Float32

from industnerf.geometry.cameras import Cameras, common_view_ball, unit_ball_projections
from industnerf.geometry.silhouettes import silhouette_distances

MAX_CELL_DISTANCE = 1.2  # no cell in use has its center farther than this from the origin


@dataclass(frozen=True)
class Silhouettes:
    """What all views know of the region of interest."""

    distance: Float32[np.ndarray, "views h w"]  # px, at most MAX_DISTANCE_PX either way
    projection: Float32[np.ndarray, "views 3 4"]  # (x, y, z, 1) to (u d, v d, d), d the depth
    max_focal_px: Float32[np.ndarray, "views"]  # a step s at depth d spans at most this * s / d px
    pixel_size: float  # the step that spans a pixel of the nearest view at the ball's near end
    center: Float[np.ndarray, "3"]  # of the region of interest, mm
    radius_mm: float


def distance_images(
    mask: Bool[np.ndarray, "views h w"], cameras: Cameras, dilation_px: float
) -> Silhouettes:
    """Distance images of `mask`, whose outlines run `dilation_px` outside the part's."""
    center, radius_mm = common_view_ball(cameras)
    K = cameras.K.copy()
    K[:, :2, 2] -= 0.5
    camera_distance = np.linalg.norm(cameras.centers - center, axis=1) / radius_mm
    focal = cameras.K[:, [0, 1], [0, 1]].max(axis=1)
    # d(u, v) of a step s at the angle a off the axis is at most f s / (depth cos a)
    slant = np.arcsin(np.minimum(MAX_CELL_DISTANCE / camera_distance, 0.99))
    return Silhouettes(
        silhouette_distances(mask) - np.float32(dilation_px),
        unit_ball_projections(replace(cameras, K=K), center, radius_mm),
        (focal / np.cos(slant)).astype(np.float32),
        float(((camera_distance - 1) / focal).min()),
        center,
        radius_mm,
    )


def bilinear(
    image: Float32[np.ndarray, "h w"], u: Float32[np.ndarray, "n"], v: Float32[np.ndarray, "n"]
) -> Float32[np.ndarray, "n"]:
    """`image` at (u, v), bilinear between pixel centers; outside, its border continues."""
    height, width = image.shape
    u, v = u.clip(0, width - 1.001), v.clip(0, height - 1.001)
    left, top = u.astype(np.int32), v.astype(np.int32)
    at, flat = top * width + left, image.ravel()
    u -= left
    v -= top
    upper, lower = flat.take(at), flat.take(at + width)
    upper += u * (flat.take(at + 1) - upper)
    lower += u * (flat.take(at + (width + 1)) - lower)
    upper += v * (lower - upper)
    return upper
