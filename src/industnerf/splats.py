"""Clouds as small pictures, seen by one of the part's own cameras."""

from pathlib import Path

import numpy as np
from jaxtyping import Float, Int64, UInt8
from PIL import Image

from industnerf.artifacts.files import atomic_write
from industnerf.geometry.cameras import Cameras, project

BACKGROUND = np.array([255, 255, 255], np.uint8)
GRAY = np.array([140, 160, 185], np.uint8)  # of a cloud without colors
SPLAT_RADIUS = 1  # px; a point covers (2 SPLAT_RADIUS + 1)^2 pixels
CORE_SHARE = 0.99  # of the points, along each axis: what lies far beyond them is stray
PREVIEW_MARGIN = 0.03  # of the size, on each side
PREVIEW_VIEWS = ((1.0, -1.2, 0.9), (-1.0, 1.2, 0.9), (0.05, -0.05, 1.0), (1.2, -1.0, -0.9))
SHADING_STRENGTH = 4.0


def splat(
    points_mm: Float[np.ndarray, "n 3"],
    colors: UInt8[np.ndarray, "n 3"],
    cameras: Cameras,
    view: int,
    size: int,
) -> UInt8[np.ndarray, "size size 3"]:
    """The points as the camera `view` would see them, nearest on top, with shaded relief."""
    uv, depth = project(points_mm, cameras.K[view], cameras.c2w[view])
    pixel = np.floor(uv * size / cameras.width).astype(np.int64)
    return _draw(pixel, depth, colors, size, SPLAT_RADIUS)


def preview(
    points: Float[np.ndarray, "n 3"], colors: UInt8[np.ndarray, "n 3"] | None, size: int = 360
) -> UInt8[np.ndarray, "{size} 4*{size} 3"]:
    """The points from four sides in a row, in parallel projection; z is up.

    The frame is that of the points without strays.  A cloud without colors is gray.
    """
    colors = np.broadcast_to(GRAY, points.shape) if colors is None else colors
    center = np.mean(core_box(points), axis=0)
    spread = np.linalg.norm(points - center, axis=1)
    radius = float(np.quantile(spread, CORE_SHARE)) or 1.0
    scale = (0.5 - PREVIEW_MARGIN) * size / radius
    # so large that points at random on half of a tile leave few gaps
    splat_radius = int(np.clip(np.ceil(0.75 * size / np.sqrt(len(points))), SPLAT_RADIUS, 6))
    tiles = []
    for back in PREVIEW_VIEWS:
        x, y, z = ((points - center) @ _viewing_axes(back).T).T
        pixel = np.floor(np.stack([size / 2 + scale * x, size / 2 - scale * y], axis=1))
        tiles.append(_draw(pixel.astype(np.int64), -z, colors, size, splat_radius))
    return np.hstack(tiles)


def save_preview(
    path: Path, points: Float[np.ndarray, "n 3"], colors: UInt8[np.ndarray, "n 3"] | None
) -> None:
    """Write the `preview` of a cloud as PNG; raises BadArtifact if `path` cannot be written."""
    with atomic_write(path) as draft:
        Image.fromarray(preview(points, colors)).save(draft, "PNG")


def core_box(
    points: Float[np.ndarray, "n 3"],
) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """The lowest and the highest corner of the box of the points without strays.

    Those are what lies beyond the middle 99 % along each axis by more than half of its diagonal.
    """
    low, high = np.quantile(points, [(1 - CORE_SHARE) / 2, (1 + CORE_SHARE) / 2], axis=0)
    margin = np.linalg.norm(high - low) / 2
    core = points[((points >= low - margin) & (points <= high + margin)).all(axis=1)]
    return core.min(axis=0).astype(np.float64), core.max(axis=0).astype(np.float64)


def _viewing_axes(back: tuple[float, float, float]) -> Float[np.ndarray, "3 3"]:
    """Rows: right, up, and `back` towards the camera."""
    towards = np.array(back) / np.linalg.norm(back)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(towards, right), towards])


def _draw(
    pixel: Int64[np.ndarray, "n 2"],
    depth: Float[np.ndarray, "n"],
    colors: UInt8[np.ndarray, "n 3"],
    size: int,
    radius: int,
) -> UInt8[np.ndarray, "size size 3"]:
    """Squares of 2 `radius` + 1 pixels, nearest on top, with shaded relief."""
    order = np.argsort(-depth)  # far to near: later writes win
    pixel, depth, colors = pixel[order], depth[order], colors[order]
    image = np.tile(BACKGROUND, (size, size, 1))
    nearest = np.full((size, size), np.inf)
    for down in range(-radius, radius + 1):
        for right in range(-radius, radius + 1):
            column, row = pixel[:, 0] + right, pixel[:, 1] + down
            inside = (column >= 0) & (column < size) & (row >= 0) & (row < size)
            inside[inside] = depth[inside] <= nearest[row[inside], column[inside]]
            nearest[row[inside], column[inside]] = depth[inside]
            image[row[inside], column[inside]] = colors[inside]
    return (image * eye_dome_shading(nearest, float(np.ptp(depth)))[..., None]).astype(np.uint8)


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
