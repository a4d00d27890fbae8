"""Section 3.4: confidence of the source views in the cloud points, and the surface they see.

Equations (10)-(13) themselves are in `industnerf.rendering.confidence`; this file re-renders every
view and collects its confidences.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float32, Int64
from torch import Tensor

from industnerf.methods.industnerf.ray_sampler import RaySampler
from industnerf.methods.industnerf.scene import NerfScene
from industnerf.rendering.confidence import color_confidence, color_scale, max_over_views
from industnerf.rendering.render import Renderer
from industnerf.schema.readings import Readings


@dataclass(frozen=True)
class ObservedSurface:
    """Points where the rays of source pixels meet the surface: half of their light is left."""

    points: Float32[Tensor, "n 3"]
    rgb: Float32[Tensor, "n 3"]
    confidence: Float32[Tensor, "n"]  # (12) of the pixel, times its opacity
    view: Int64[Tensor, "n"]

    def select(self, mask: Bool[Tensor, "n"]) -> "ObservedSurface":
        """Those of the points in `mask`."""
        return ObservedSurface(*(values[mask] for values in vars(self).values()))


@dataclass(frozen=True)
class ViewConfidence:
    """Confidence (13) of every point, the maximum over the views, and the surface."""

    confidence: Float32[Tensor, "m"]
    view: Int64[Tensor, "m"]  # that has the maximum; -1: none
    surface: ObservedSurface
    per_view: Float32[Tensor, "v m"]  # (13), view by view


@torch.no_grad()
def compute_view_confidence(
    scene: NerfScene,
    ray_sampler: RaySampler,
    renderer: Renderer,
    values: Float32[Tensor, "m"],
    rgb: Float32[Tensor, "m 3"],
    readings: Readings,
) -> ViewConfidence:
    """Re-render every source view, and collect its confidence in every point."""
    scale = color_scale(readings.color_scale, color_contrast(ray_sampler))
    surfaces: list[ObservedSurface] = []
    view_confidences = []
    for view in range(len(scene)):
        view_confidence = torch.zeros_like(values)
        in_view = ray_sampler.visible_pixels[:, 0] == view
        for pixels in ray_sampler.visible_pixels[in_view].split(renderer.chunk_size):
            middle = torch.full((len(pixels),), 0.5).to(values)
            rays, target, background = ray_sampler.rays(pixels, middle)
            output = renderer.render(rays, values, rgb)
            pixel_confidence = color_confidence(target, output.composite_over(background), scale)
            renderer.accumulate_confidence(
                values,
                pixel_confidence,
                view_confidence,
                transmittance=readings.transmittance,
                opacity=readings.opacity,
                samples=readings.sample_reduction,
            )
            hit = output.median_depth > 0
            surfaces.append(
                ObservedSurface(
                    (rays.origins + output.median_depth[:, None] * rays.directions)[hit],
                    target[hit],
                    (pixel_confidence * (1 - output.transmittance))[hit],
                    pixels[hit, 0],
                )
            )
        view_confidences.append(view_confidence.clamp(max=1))
    per_view = torch.stack(view_confidences)
    return ViewConfidence(*max_over_views(per_view), concatenate(surfaces), per_view)


def color_contrast(ray_sampler: RaySampler) -> float:
    """L of eq. (12) under reading R8 `contrast`: the diagonal of the box of all pixel colors.

    At least one step of an 8-bit image, because (12) divides by it.
    """
    view, row, column = ray_sampler.visible_pixels.unbind(1)
    colors = ray_sampler.colors[view, row, column]
    return max(float((colors.amax(0) - colors.amin(0)).norm()), 1 / 255) if len(colors) else 1.0


def concatenate(surfaces: list[ObservedSurface]) -> ObservedSurface:
    """All points of the surfaces, in one."""
    columns = zip(*(vars(surface).values() for surface in surfaces), strict=True)
    return ObservedSurface(*(torch.cat(column) for column in columns))


def voxel_downsample(surface: ObservedSurface, voxel_size: float) -> ObservedSurface:
    """One point a voxel: the mean position, and the attributes of the most confident point.

    Pixels are dense where many views face the surface; the result is even.
    """
    _, voxel = torch.unique(voxel_ids(surface.points, voxel_size), return_inverse=True)
    count = torch.bincount(voxel)
    mean = surface.points.new_zeros(len(count), 3).index_add(0, voxel, surface.points)
    mean = mean / count[:, None]
    by_confidence = torch.argsort(surface.confidence, stable=True)
    rank = torch.empty_like(voxel)
    rank[by_confidence] = torch.arange(len(rank), device=rank.device)
    most_confident = by_confidence[torch.zeros_like(count).scatter_reduce(0, voxel, rank, "amax")]
    return ObservedSurface(
        mean,
        surface.rgb[most_confident],
        surface.confidence[most_confident],
        surface.view[most_confident],
    )


def voxel_ids(points: Float32[Tensor, "n 3"], voxel_size: float) -> Int64[Tensor, "n"]:
    """A number for the voxel of each point, ordered by x, then y, then z.

    Sorting numbers is forty times as fast as sorting rows of three.
    """
    x, y, z = (points / voxel_size).floor().long().unbind(1)
    if not len(points):
        return x
    y, z = y - y.min(), z - z.min()
    return (x * (y.max() + 1) + y) * (z.max() + 1) + z
