"""What the source views say of the points: section 3.4, and the surface that they see."""

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
    """Where pixels of the source views meet the surface: half of their light is left there."""

    points: Float32[Tensor, "n 3"]
    rgb: Float32[Tensor, "n 3"]
    confidence: Float32[Tensor, "n"]  # (12) of the pixel, times its opacity
    view: Int64[Tensor, "n"]

    def select(self, mask: Bool[Tensor, "n"]) -> "ObservedSurface":
        """These of the points, in this order."""
        return ObservedSurface(*(values[mask] for values in vars(self).values()))


@dataclass(frozen=True)
class ViewConfidence:
    """(13) of every point in the view that is surest of it, which view that is, and the surface."""

    confidence: Float32[Tensor, "m"]
    view: Int64[Tensor, "m"]  # -1: none
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
    """Re-render every source view and ask it for its confidence in every point."""
    scale = color_scale(readings.color_scale, color_contrast(ray_sampler))
    surfaces: list[ObservedSurface] = []
    view_confidences = []
    for view in range(len(scene)):
        view_confidence = torch.zeros_like(values)
        for pixels in ray_sampler.visible_pixels[ray_sampler.visible_pixels[:, 0] == view].split(
            renderer.chunk_size
        ):
            rays, target, background = ray_sampler.rays(
                pixels, torch.full((len(pixels),), 0.5).to(values)
            )
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
    """R8 `contrast`: the largest distance between two colors of the views, along their axes.

    At least one step of an 8-bit picture, for (12) divides by it.
    """
    view, row, column = ray_sampler.visible_pixels.unbind(1)
    colors = ray_sampler.colors[view, row, column]
    return max(float((colors.amax(0) - colors.amin(0)).norm()), 1 / 255) if len(colors) else 1.0


def concatenate(surfaces: list[ObservedSurface]) -> ObservedSurface:
    """All of `parts` in one."""
    columns = zip(*(vars(surface).values() for surface in surfaces), strict=True)
    return ObservedSurface(*(torch.cat(column) for column in columns))


def voxel_downsample(surface: ObservedSurface, voxel_size: float) -> ObservedSurface:
    """One point for every cell of side `spacing`: the mean of those in it, of the surest the rest.

    Pixels crowd where views are many and faces look at them; a surface is sought that is even.
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
    """A number for the cell of each point, in the order of x, then y, then z.

    Sorting numbers takes a fortieth of the time of sorting rows of three.
    """
    x, y, z = (points / voxel_size).floor().long().unbind(1)
    if not len(points):
        return x
    y, z = y - y.min(), z - z.min()
    return (x * (y.max() + 1) + y) * (z.max() + 1) + z
