"""One photograph: the radiance at each pixel's center, then the means of the pixels on an edge."""

from collections.abc import Iterable, Iterator

import numpy as np
from jaxtyping import Bool, Float, Float32, Int

from industnerf.artifacts.views import RgbdImage
from industnerf.capture.edges import BACKGROUND, Radiance, edge_mask, pixel_means
from industnerf.capture.ray_hits import Surface, SurfacePoints
from industnerf.capture.rng import RandomStreams
from industnerf.capture.sensor import simulate_sensor
from industnerf.capture.shading import Shading
from industnerf.geometry.cameras import back_projection, project
from industnerf.schema import ViewsParams

NUM_DIRECTIONS = 16  # directions in the image along which the part is bounded
MARGIN_PX = 0.01  # far above what float32 does to a pixel coordinate, 1e-4 px

Window = tuple[slice, slice]  # rows and columns of an image
FRAME = slice(None), slice(None)


def render_image(
    surface: Surface,
    shade: Shading,
    K: Float[np.ndarray, "3 3"],
    c2w: Float[np.ndarray, "4 4"],
    background: Float[np.ndarray, "3"],
    settings: ViewsParams,
    streams: RandomStreams,
) -> RgbdImage:
    """The photograph of `surface` from one camera.

    Mask and depth are those of the pixel centers; color is the mean over the pixel.
    """
    side, camera_center = settings.resolution, c2w[:3, 3]
    ray_basis = back_projection(K, c2w).astype(np.float32)
    is_candidate = candidate_pixels(project(surface.vertices, K, c2w)[0], side)
    window = bounding_window(is_candidate)
    shape, top_left = is_candidate[window].shape, (window[0].start, window[1].start)

    def trace_rays(directions: Float32[np.ndarray, "rays 3"]) -> tuple[SurfacePoints, Radiance]:
        hits = surface.intersect(camera_center, directions)
        return hits, shade(hits)

    candidate_ids = np.flatnonzero(is_candidate[window])
    rays = pixel_center_rays(ray_basis, side, window).take(candidate_ids, axis=0)
    hits, radiance = trace_rays(rays)
    window_depth, hit_ids = np.zeros(shape, np.float32), candidate_ids[hits.ray]
    window_depth.flat[hit_ids] = hits.t
    radiance = scatter(radiance, hit_ids, window_depth.size).reshape(-1, *shape)

    def radiance_at(uv: Float32[np.ndarray, "n 2"]) -> Radiance:
        hits, radiance = trace_rays(uv @ ray_basis[:, :2].T + ray_basis[:, 2])
        return scatter(radiance, hits.ray, len(uv))

    edge_ids = np.flatnonzero(edge_mask(window_depth, radiance, K[0, 0]))
    mean, coverage = pixel_means(radiance, edge_ids, radiance_at, settings.edge_samples, top_left)
    depth = np.zeros((side, side), np.float32)
    depth[window] = window_depth
    planes = composite(mean, coverage, shade.tint, background)
    final_radiance = uncropped(planes, window, side, background)
    return RgbdImage(
        simulate_sensor(final_radiance, settings.sensor, streams.generator("noise")),
        depth > 0,
        depth,
    )


def scatter(
    radiance: Float32[np.ndarray, "channels hits"], indices: Int[np.ndarray, "hits"], rays: int
) -> Float32[np.ndarray, "channels {rays}"]:
    """`radiance` of the rays `indices`, among all `rays`; BACKGROUND at the others."""
    everywhere = np.full((len(radiance), rays), BACKGROUND)
    for plane, values in zip(everywhere, radiance, strict=True):
        plane[indices] = values
    return everywhere


def candidate_pixels(
    points: Float[np.ndarray, "n 2"], side: int
) -> Bool[np.ndarray, "{side} {side}"]:
    """Pixels whose center lies in a polygon of 2 * NUM_DIRECTIONS sides around projected `points`.

    A mesh lies in the convex hull of its vertices, and what lies before the camera is projected
    into the hull of the projected vertices.  The polygon contains that hull: a ray through a
    pixel outside it cannot meet the mesh.
    """
    # none is vertical: all bound u
    angle = (np.arange(NUM_DIRECTIONS) + 0.5) * (np.pi / NUM_DIRECTIONS)
    across, down = np.cos(angle), np.sin(angle)
    projections = points @ np.stack([across, down])
    bounds = np.stack([projections.min(axis=0) - MARGIN_PX, projections.max(axis=0) + MARGIN_PX])
    centers = np.arange(side) + 0.5
    ends = np.sort((bounds - centers[:, None, None] * down) / across, axis=1)
    left, right = ends[:, 0].max(axis=1), ends[:, 1].min(axis=1)
    return (centers >= left[:, None]) & (centers <= right[:, None])


def bounding_window(is_inside: Bool[np.ndarray, "h w"]) -> Window:
    """Rows and columns of all pixels that are inside, and where there is one their neighbors'."""
    ends = []
    for axis in (1, 0):
        inside = np.flatnonzero(is_inside.any(axis=axis))
        start, stop = inside.min(initial=is_inside.shape[1 - axis]), inside.max(initial=-1)
        ends.append(slice(max(int(start) - 1, 0), int(stop) + 2))
    return ends[0], ends[1]


def pixel_center_rays(
    ray_basis: Float32[np.ndarray, "3 3"], side: int, window: Window = FRAME
) -> Float32[np.ndarray, "pixels 3"]:
    """Directions through the pixel centers in `window`; their z in the camera is 1: t is depth."""
    pixel_centers = np.arange(side, dtype=np.float32) + np.float32(0.5)
    rows, columns = (pixel_centers[part] for part in window)
    grid = np.empty((len(rows), len(columns), 3), np.float32)
    for axis, (u, v, one) in enumerate(ray_basis):
        np.add.outer(v * rows + one, u * columns, out=grid[..., axis])
    return grid.reshape(-1, 3)


def composite(
    radiance: Float32[np.ndarray, "channels h w"],
    coverage: Float32[np.ndarray, "h w"],
    tint: tuple[float, ...],
    background: Float[np.ndarray, "3"],
) -> Iterator[Float32[np.ndarray, "h w"]]:
    """Linear radiance over the background, color by color, white being 255.

    `radiance` counts covered area only.
    """
    uncovered = 1 - coverage
    for color, albedo in enumerate(tint):
        background_level = np.float32(255 * background[color])
        yield (
            np.float32(255 * albedo) * radiance[color % len(radiance)]
            + background_level * uncovered
        )


def uncropped(
    planes: Iterable[Float32[np.ndarray, "h w"]],
    window: Window,
    side: int,
    background: Float[np.ndarray, "3"],
) -> Iterator[Float32[np.ndarray, "{side} {side}"]]:
    """`planes`, the colors in `window`, with the background around them."""
    for plane, level in zip(planes, background, strict=True):
        image = np.full((side, side), np.float32(255 * level))
        image[window] = plane
        yield image
