"""One photograph: rays through the pixel centres, then more of them where there is an edge."""

import numpy as np
from jaxtyping import Float, Float32, Int, UInt8

from industnerf.artifacts.views import Frame
from industnerf.capture.pixels import may_show, on_edge, sample_pattern
from industnerf.capture.surface import Surface
from industnerf.geometry.cameras import back_projection, project
from industnerf.schema import ViewsParams


def develop(
    surface: Surface,
    K: Float[np.ndarray, "3 3"],
    c2w: Float[np.ndarray, "4 4"],
    settings: ViewsParams,
) -> Frame:
    """The photograph of `surface` from one camera.

    Mask and depth are those of the pixel centres; colour is the mean over the pixel.
    """
    side, towards = settings.resolution, back_projection(K, c2w).astype(np.float32)
    corners, _ = project(surface.vertices, K, c2w)
    candidates = np.flatnonzero(may_show(corners, side))
    seen = surface.look(c2w[:3, 3], through_centres(towards, side).take(candidates, axis=0))
    shown = candidates[seen.ray]
    depth, light, cover = np.zeros((3, side, side), np.float32)
    depth.flat[shown], light.flat[shown], cover.flat[shown] = seen.t, seen.irradiance, 1
    mask = depth > 0
    edge = np.flatnonzero(on_edge(depth, light, K[0, 0]))
    samples = settings.edge_samples
    within = surface.look(c2w[:3, 3], through_pixels(towards, edge, side, samples))
    pixel = within.ray // samples
    cover.flat[edge] = np.bincount(pixel, minlength=len(edge)) / samples
    light.flat[edge] = np.bincount(pixel, within.irradiance, len(edge)) / samples
    return Frame(composed(light, cover, settings), mask, depth)


def through_centres(
    towards: Float32[np.ndarray, "3 3"], side: int
) -> Float32[np.ndarray, "pixels 3"]:
    """Directions through all pixel centres; their z in the camera is 1, so t is depth."""
    at = np.arange(side, dtype=np.float32) + np.float32(0.5)
    grid = np.empty((side, side, 3), np.float32)
    for axis, (u, v, one) in enumerate(towards):
        np.add.outer(v * at + one, u * at, out=grid[..., axis])
    return grid.reshape(-1, 3)


def through_pixels(
    towards: Float32[np.ndarray, "3 3"], pixels: Int[np.ndarray, "n"], side: int, samples: int
) -> Float32[np.ndarray, "rays 3"]:
    """Directions through `samples` points of each of `pixels`, pixel by pixel."""
    v, u = np.divmod(pixels, side)
    first = np.stack([u, v, np.ones_like(u)], axis=1).astype(np.float32) @ towards.T
    offsets = sample_pattern(samples).astype(np.float32) @ towards[:, :2].T
    return (first[:, None] + offsets).reshape(-1, 3)


def composed(
    light: Float32[np.ndarray, "h w"], cover: Float32[np.ndarray, "h w"], settings: ViewsParams
) -> UInt8[np.ndarray, "h w 3"]:
    """Linear radiance over the background, in 8 bits; `light` counts covered area only."""
    rgb, bare = np.empty((*light.shape, 3), np.uint8), 1 - cover
    for channel, colours in enumerate(zip(settings.albedo, settings.background, strict=True)):
        albedo, background = (np.float32(255 * colour) for colour in colours)
        value = albedo * light + background * bare
        rgb[..., channel] = np.clip(value + np.float32(0.5), 0, 255)
    return rgb
