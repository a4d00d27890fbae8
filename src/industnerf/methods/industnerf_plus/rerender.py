"""Images of the surface from any camera: the held-out views of Table 2, and previews."""

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.renderings import Renderings
from industnerf.geometry.cameras import Cameras
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays, ShadedSurface

RENDER_BETA = 0.1  # cells
RENDER_STEP = 0.25  # cells
RENDER_GROWTH = 0.1  # cells; a pixel that an outline crosses mostly shows the part


def render_views(
    surface: ShadedSurface,
    center: Float[np.ndarray, "3"],
    radius: float,
    cameras: Cameras,
    background: Float[np.ndarray, "views 3"],
) -> Renderings:
    """Color, opacity, and depth along the axis in the unit of the cameras; 0: no surface."""
    rays = PinholeRays(cameras, center, radius, surface.grid)
    pixels_of_view = np.arange(rays.height * rays.width, dtype=np.int32)
    shape = (rays.height, rays.width)
    colors, depths, opacities = [], [], []
    distance = surface.distance.numpy()
    surface.set_distance(distance - np.float32(RENDER_GROWTH))
    surface.update_band(RENDER_BETA)
    for view, axis in enumerate(rays.axes):
        pixels = pixels_of_view + view * len(pixels_of_view)
        rendered = surface.render(rays, pixels, background, RENDER_BETA, RENDER_STEP)
        hit = rendered.hit.numpy()
        depth = hit * (rays.directions(pixels) @ axis) * surface.grid.spacing * radius
        colors.append(to_uint8(rendered.color.numpy()).reshape(*shape, 3))
        depths.append(np.where(hit > 0, depth, 0).astype(np.float32).reshape(shape))
        opacities.append(to_uint8(rendered.opacity.numpy()).reshape(shape))
    surface.set_distance(distance)
    return Renderings(np.stack(colors), np.stack(depths), np.stack(opacities))


def to_uint8(values: np.ndarray) -> np.ndarray:
    return (np.clip(values, 0, 1) * 255).round().astype(np.uint8)
