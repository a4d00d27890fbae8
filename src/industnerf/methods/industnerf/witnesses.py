"""What the source views say of the points: section 3.4, and the surface that they see."""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float32, Int64
from torch import Tensor

from industnerf.methods.industnerf.pixels import Pixels
from industnerf.methods.industnerf.scene import Scene
from industnerf.rendering.confidence import colour_confidence, colour_scale, over_views
from industnerf.rendering.render import Renderer
from industnerf.schema.readings import Readings


@dataclass(frozen=True)
class Surface:
    """Where pixels of the source views meet the surface: half of their light is left there."""

    points: Float32[Tensor, "n 3"]
    rgb: Float32[Tensor, "n 3"]
    confidence: Float32[Tensor, "n"]  # (12) of the pixel, times its opacity
    view: Int64[Tensor, "n"]

    def only(self, which: Bool[Tensor, "n"]) -> "Surface":
        """These of the points, in this order."""
        return Surface(*(values[which] for values in vars(self).values()))


@dataclass(frozen=True)
class Testimony:
    """(13) of every point in the view that is surest of it, which view that is, and the surface."""

    confidence: Float32[Tensor, "m"]
    view: Int64[Tensor, "m"]  # -1: none
    surface: Surface
    of_views: Float32[Tensor, "v m"]  # (13), view by view


@torch.no_grad()
def testimony(
    scene: Scene,
    pixels: Pixels,
    renderer: Renderer,
    values: Float32[Tensor, "m"],
    rgb: Float32[Tensor, "m 3"],
    readings: Readings,
) -> Testimony:
    """Re-render every source view and ask it for its confidence in every point."""
    scale = colour_scale(readings.scale, contrast_of(pixels))
    met: list[Surface] = []
    each = []
    for view in range(len(scene)):
        own = torch.zeros_like(values)
        for shown in pixels.shown[pixels.shown[:, 0] == view].split(renderer.at_once):
            rays, target, background = pixels.rays(shown, torch.full((len(shown),), 0.5).to(values))
            seen = renderer.look(rays, values, rgb)
            agreement = colour_confidence(target, seen.over(background), scale)
            renderer.confide(
                values,
                agreement,
                own,
                transmittance=readings.transmittance,
                opacity=readings.opacity,
                samples=readings.samples,
            )
            hit = seen.median > 0
            met.append(
                Surface(
                    (rays.origins + seen.median[:, None] * rays.directions)[hit],
                    target[hit],
                    (agreement * (1 - seen.through))[hit],
                    shown[hit, 0],
                )
            )
        each.append(own.clamp(max=1))
    of_views = torch.stack(each)
    return Testimony(*over_views(of_views), joined(met), of_views)


def contrast_of(pixels: Pixels) -> float:
    """R8 `contrast`: the largest distance between two colours of the views, along their axes.

    At least one step of an 8-bit picture, for (12) divides by it.
    """
    view, row, column = pixels.shown.unbind(1)
    colours = pixels.colours[view, row, column]
    return max(float((colours.amax(0) - colours.amin(0)).norm()), 1 / 255) if len(colours) else 1.0


def joined(parts: list[Surface]) -> Surface:
    """All of `parts` in one."""
    columns = zip(*(vars(part).values() for part in parts), strict=True)
    return Surface(*(torch.cat(column) for column in columns))


def thinned(surface: Surface, spacing: float) -> Surface:
    """One point for every cell of side `spacing`: the mean of those in it, of the surest the rest.

    Pixels crowd where views are many and faces look at them; a surface is sought that is even.
    """
    _, which = torch.unique(cell_numbers(surface.points, spacing), return_inverse=True)
    count = torch.bincount(which)
    mean = surface.points.new_zeros(len(count), 3).index_add(0, which, surface.points)
    mean = mean / count[:, None]
    by_confidence = torch.argsort(surface.confidence, stable=True)
    rank = torch.empty_like(which)
    rank[by_confidence] = torch.arange(len(rank), device=rank.device)
    surest = by_confidence[torch.zeros_like(count).scatter_reduce(0, which, rank, "amax")]
    return Surface(mean, surface.rgb[surest], surface.confidence[surest], surface.view[surest])


def cell_numbers(points: Float32[Tensor, "n 3"], side: float) -> Int64[Tensor, "n"]:
    """A number for the cell of each point, in the order of x, then y, then z.

    Sorting numbers takes a fortieth of the time of sorting rows of three.
    """
    x, y, z = (points / side).floor().long().unbind(1)
    if not len(points):
        return x
    y, z = y - y.min(), z - z.min()
    return (x * (y.max() + 1) + y) * (z.max() + 1) + z
