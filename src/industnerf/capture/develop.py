"""One photograph: what each pixel's centre shows, then the means of the pixels on an edge."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float, Float32, Int

from industnerf.artifacts.views import Frame
from industnerf.capture.chance import Draws
from industnerf.capture.edges import BACKGROUND, Light, on_edge, pixel_means
from industnerf.capture.sensor import expose
from industnerf.capture.shading import Shading
from industnerf.capture.surface import Spots, Surface
from industnerf.geometry.cameras import back_projection, project
from industnerf.schema import ViewsParams

AXES = 16  # directions in the image along which the part is bounded
MARGIN_PX = 0.01  # far above what float32 does to a pixel coordinate, 1e-4 px


def develop(
    surface: Surface,
    shade: Shading,
    K: Float[np.ndarray, "3 3"],
    c2w: Float[np.ndarray, "4 4"],
    background: Float[np.ndarray, "3"],
    settings: ViewsParams,
    draws: Draws,
) -> Frame:
    """The photograph of `surface` from one camera.

    Mask and depth are those of the pixel centres; colour is the mean over the pixel.
    """
    side, eye = settings.resolution, c2w[:3, 3]
    towards = back_projection(K, c2w).astype(np.float32)
    candidates = np.flatnonzero(may_show(project(surface.vertices, K, c2w)[0], side))

    def shown_by(directions: Float32[np.ndarray, "rays 3"]) -> tuple[Spots, Light]:
        spots = surface.look(eye, directions)
        return spots, shade(spots)

    spots, light = shown_by(through_centres(towards, side).take(candidates, axis=0))
    depth, shown = np.zeros((side, side), np.float32), candidates[spots.ray]
    depth.flat[shown] = spots.t
    light = spread(light, shown, side * side).reshape(-1, side, side)

    def light_at(uv: Float32[np.ndarray, "n 2"]) -> Light:
        spots, light = shown_by(uv @ towards[:, :2].T + towards[:, 2])
        return spread(light, spots.ray, len(uv))

    edge = np.flatnonzero(on_edge(depth, light, K[0, 0]))
    mean, cover = pixel_means(light, edge, light_at, settings.edge_samples)
    radiance = composed(mean, cover, shade.tint, background)
    return Frame(expose(radiance, settings.sensor, draws.of("noise")), depth > 0, depth)


def spread(
    light: Float32[np.ndarray, "channels hits"], at: Int[np.ndarray, "hits"], rays: int
) -> Float32[np.ndarray, "channels {rays}"]:
    """`light` of the rays `at`, among all `rays`; BACKGROUND at the others."""
    everywhere = np.full((len(light), rays), BACKGROUND)
    for plane, values in zip(everywhere, light, strict=True):
        plane[at] = values
    return everywhere


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
    light: Float32[np.ndarray, "channels h w"],
    cover: Float32[np.ndarray, "h w"],
    tint: tuple[float, ...],
    background: Float[np.ndarray, "3"],
) -> Iterator[Float32[np.ndarray, "h w"]]:
    """Linear radiance over the background, colour by colour, white being 255.

    `light` counts covered area only.
    """
    bare = 1 - cover
    for colour, albedo in enumerate(tint):
        behind = np.float32(255 * background[colour])
        yield np.float32(255 * albedo) * light[colour % len(light)] + behind * bare
