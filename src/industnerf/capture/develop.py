"""One photograph: what each pixel's centre shows, then its mean over the pixels on an edge."""

import numpy as np
from jaxtyping import Float, Float32, UInt8

from industnerf.artifacts.views import Frame
from industnerf.capture.pixels import may_show, on_edge, pixel_means
from industnerf.capture.surface import BACKGROUND, Surface
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
    side, eye = settings.resolution, c2w[:3, 3]
    towards = back_projection(K, c2w).astype(np.float32)
    corners, _ = project(surface.vertices, K, c2w)
    candidates = np.flatnonzero(may_show(corners, side))
    hits = surface.look(eye, through_centres(towards, side).take(candidates, axis=0))
    depth, light = np.zeros((side, side), np.float32), np.full((side, side), BACKGROUND)
    shown = candidates[hits.ray]
    depth.flat[shown], light.flat[shown] = hits.t, hits.light

    def light_at(uv: Float32[np.ndarray, "n 2"]) -> Float32[np.ndarray, "n"]:
        return surface.light(eye, uv @ towards[:, :2].T + towards[:, 2])

    edge = np.flatnonzero(on_edge(depth, light, K[0, 0]))
    mean, cover = pixel_means(light, edge, light_at, settings.edge_samples)
    return Frame(composed(mean, cover, settings), depth > 0, depth)


def through_centres(
    towards: Float32[np.ndarray, "3 3"], side: int
) -> Float32[np.ndarray, "pixels 3"]:
    """Directions through all pixel centres; their z in the camera is 1, so t is depth."""
    at = np.arange(side, dtype=np.float32) + np.float32(0.5)
    grid = np.empty((side, side, 3), np.float32)
    for axis, (u, v, one) in enumerate(towards):
        np.add.outer(v * at + one, u * at, out=grid[..., axis])
    return grid.reshape(-1, 3)


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
