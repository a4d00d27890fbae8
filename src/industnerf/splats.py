"""Clouds as small pictures, seen by one of the part's own cameras."""

import numpy as np
from jaxtyping import Float, Int64, UInt8

from industnerf.geometry.cameras import Cameras, project

BACKGROUND = np.array([255, 255, 255], np.uint8)
SPLAT_RADIUS = 1  # a point covers (2 SPLAT_RADIUS + 1)^2 pixels
SHADING_STRENGTH = 4.0  # strength of the shading


def splat(
    points_mm: Float[np.ndarray, "n 3"],
    colors: UInt8[np.ndarray, "n 3"],
    cameras: Cameras,
    view: int,
    size: int,
) -> UInt8[np.ndarray, "size size 3"]:
    """The points as the camera `view` would see them, nearest on top, with shaded relief."""
    uv, depth = project(points_mm, cameras.K[view], cameras.c2w[view])
    order = np.argsort(-depth)  # far to near: later writes win
    pixel, depth, colors = _pixels(uv[order], cameras.width, size), depth[order], colors[order]
    image = np.tile(BACKGROUND, (size, size, 1))
    nearest = np.full((size, size), np.inf)
    for down in range(-SPLAT_RADIUS, SPLAT_RADIUS + 1):
        for right in range(-SPLAT_RADIUS, SPLAT_RADIUS + 1):
            column, row = pixel[:, 0] + right, pixel[:, 1] + down
            inside = (column >= 0) & (column < size) & (row >= 0) & (row < size)
            inside[inside] = depth[inside] <= nearest[row[inside], column[inside]]
            nearest[row[inside], column[inside]] = depth[inside]
            image[row[inside], column[inside]] = colors[inside]
    return (image * eye_dome_shading(nearest, float(np.ptp(depth)))[..., None]).astype(np.uint8)


def _pixels(uv: Float[np.ndarray, "n 2"], width: int, size: int) -> Int64[np.ndarray, "n 2"]:
    return np.floor(uv * size / width).astype(np.int64)


def eye_dome_shading(
    depth: Float[np.ndarray, "h w"], depth_range: float
) -> Float[np.ndarray, "h w"]:
    """Brightness in (0, 1]: a pixel is darker the further its neighbors stand before it.

    Eye-dome lighting -- Boucheny (2009): clouds have no normals, but depth alone shows form.
    """
    deepest = np.nanmax(np.where(np.isfinite(depth), depth, -np.inf)) + depth_range
    filled = np.where(np.isfinite(depth), depth, deepest)
    occlusion = np.zeros_like(filled)
    for axis in (0, 1):
        for shift in (-2, -1, 1, 2):
            occlusion += np.clip(filled - np.roll(filled, shift, axis), 0, 0.1 * depth_range)
    shade = np.exp(-SHADING_STRENGTH * occlusion / max(depth_range, 1e-12))
    return np.where(np.isfinite(depth), shade, 1.0)
