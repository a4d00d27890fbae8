"""One photograph: what each pixel's centre shows, then the means of the pixels on an edge."""

import numpy as np
from jaxtyping import Bool, Float, Float32, UInt8

from industnerf.artifacts.views import Frame
from industnerf.capture.edges import BACKGROUND, on_edge, pixel_means
from industnerf.capture.surface import Surface
from industnerf.geometry.cameras import back_projection, project
from industnerf.schema import ViewsParams

AXES = 16  # directions in the image along which the part is bounded
MARGIN_PX = 0.01  # far above what float32 does to a pixel coordinate, 1e-4 px


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
    candidates = np.flatnonzero(may_show(project(surface.vertices, K, c2w)[0], side))
    seen = surface.look(eye, through_centres(towards, side).take(candidates, axis=0))
    depth, light = np.zeros((side, side), np.float32), np.full((side, side), BACKGROUND)
    shown = candidates[seen.ray]
    depth.flat[shown], light.flat[shown] = seen.t, seen.light

    def light_at(uv: Float32[np.ndarray, "n 2"]) -> Float32[np.ndarray, "n"]:
        return surface.light_along(eye, uv @ towards[:, :2].T + towards[:, 2])

    edge = np.flatnonzero(on_edge(depth, light, K[0, 0]))
    mean, cover = pixel_means(light, edge, light_at, settings.edge_samples)
    return Frame(composed(mean, cover, settings), depth > 0, depth)


def may_show(points: Float[np.ndarray, "n 2"], side: int) -> Bool[np.ndarray, "{side} {side}"]:
    """Pixels whose centre lies in the polygon of 2 * AXES sides around the projected `points`.

    A mesh lies in the convex hull of its vertices, and what lies before the camera is projected
    into the hull of the projected vertices.  The polygon contains that hull: a ray through a
    pixel outside it cannot meet the mesh.
    """
    angle = (np.arange(AXES) + 0.5) * (np.pi / AXES)  # none is vertical: all bound u
    across, down = np.cos(angle), np.sin(angle)
    along = points @ np.stack([across, down])
    bounds = np.stack([along.min(axis=0) - MARGIN_PX, along.max(axis=0) + MARGIN_PX])
    centres = np.arange(side) + 0.5
    ends = np.sort((bounds - centres[:, None, None] * down) / across, axis=1)
    left, right = ends[:, 0].max(axis=1), ends[:, 1].min(axis=1)
    return (centres >= left[:, None]) & (centres <= right[:, None])


def through_centres(
    towards: Float32[np.ndarray, "3 3"], side: int
) -> Float32[np.ndarray, "{side*side} 3"]:
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
        rgb[..., channel] = np.minimum(value, 255) + np.float32(0.5)  # the cast rounds down
    return rgb
