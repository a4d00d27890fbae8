"""The color behind the part in every view, and whether the part stands out from it.

A method that segments the part by color loses what looks like the background.  So `contrast`
chooses, as a photographer would, one color for all views of a part that none of its finishes looks
like under the lamps in use: white where it serves, and else the next of `COLORS`.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, UInt8

from industnerf.artifacts.views import RgbdImage
from industnerf.capture.image_formation import composite, pixel_center_rays
from industnerf.capture.ray_hits import Surface
from industnerf.capture.rng import RandomStreams
from industnerf.capture.sensor import quantize
from industnerf.capture.shading import Shading
from industnerf.geometry.cameras import Cameras, back_projection
from industnerf.schema import ViewsParams

COLORS = {  # in the order in which `contrast` tries them
    "white": (255, 255, 255),
    "black": (0, 0, 0),
    "gray": (128, 128, 128),
    "green": (0, 255, 0),
    "magenta": (255, 0, 255),
    "blue": (0, 0, 255),
}
METER_PX = 64  # side of the images in which the colors of a part are looked at beforehand
TOLERANCE = 0.02  # in [0, 1]; `background_tolerance` of the methods, below which a pixel is lost
CHOICE_TOLERANCE = 0.05  # in [0, 1]; wider, for blur, noise and compression are still to come
CHOICE_SHARE = 1e-3  # of the part's pixels: so many may be within it
MAX_MATCHING_SHARE = 0.01  # of the part's pixels within TOLERANCE: more give a warning

PartColors = UInt8[np.ndarray, "_ 3"]  # of each pixel that shows the part


@dataclass
class Likeness:
    """Counts the part's pixels, and those that look like the background."""

    pixels: int = 0
    matching: int = 0

    def add(self, colors: PartColors, background: Float[np.ndarray, "3"]) -> None:
        """Count the `colors` of pixels of the part in one view; `background` is in [0, 1]."""
        self.pixels += len(colors)
        self.matching += int(is_like(colors, background, TOLERANCE).sum())

    def count(
        self, images: Iterable[RgbdImage], background: Float[np.ndarray, "n 3"]
    ) -> Iterator[RgbdImage]:
        """`images`, each counted as it passes."""
        for image, color in zip(images, background, strict=True):
            self.add(image.rgb[image.mask], color)
            yield image

    @property
    def warning(self) -> str:
        """A sentence if more than MAX_MATCHING_SHARE of the part's pixels match, else nothing."""
        share = self.matching / max(self.pixels, 1)
        if share <= MAX_MATCHING_SHARE:
            return ""
        return (
            f"{share:.1%} of its pixels are within {TOLERANCE:g} of the background's color, and "
            "are lost to methods that segment by it (views.background: contrast avoids it where "
            "any color does)"
        )


def is_like(
    colors: PartColors, background: Float[np.ndarray, "3"], tolerance: float
) -> Bool[np.ndarray, "_"]:
    """Whether no channel of each color is farther than `tolerance` from `background`, in [0, 1]."""
    return (np.abs(colors - 255 * background) <= 255 * tolerance).all(axis=1)


def backgrounds(
    settings: ViewsParams, view_streams: list[RandomStreams], part_colors: Iterable[PartColors]
) -> Float[np.ndarray, "n 3"]:
    """The background of each view, in [0, 1]; `part_colors` are read for `contrast` alone.

    All are multiples of 1/255, so that an image without noise shows them exactly.
    """
    if settings.background == "random":
        colors = [streams.generator("background").integers(0, 256, 3) for streams in view_streams]
        return np.array(colors) / 255
    name = settings.background
    if name == "contrast":
        name = contrasting_color(np.concatenate(list(part_colors)))
    return np.tile(np.array(COLORS[name]) / 255, (len(view_streams), 1))


def contrasting_color(colors: PartColors) -> str:
    """The first of COLORS that hardly one of `colors` is like; if there is none, the least like.

    Without any color, of a part that no camera sees, white.
    """
    if not len(colors):
        return "white"
    shares = {
        name: float(is_like(colors, np.array(color) / 255, CHOICE_TOLERANCE).mean())
        for name, color in COLORS.items()
    }
    distinct = (name for name, share in shares.items() if share <= CHOICE_SHARE)
    return next(distinct, min(COLORS, key=lambda name: shares[name]))


def metered_colors(
    surface: Surface, shadings: Sequence[Shading], cameras: Cameras
) -> Iterator[PartColors]:
    """The colors of the part in each view, METER_PX a side, before the sensor."""
    scale = np.diag([METER_PX / cameras.width, METER_PX / cameras.height, 1.0])
    for shade, K, c2w in zip(shadings, cameras.K, cameras.c2w, strict=True):
        ray_basis = back_projection(scale @ K, c2w).astype(np.float32)
        hits = surface.intersect(c2w[:3, 3], pixel_center_rays(ray_basis, METER_PX))
        radiance = shade(hits)[:, None]
        coverage = np.ones(radiance.shape[1:], np.float32)
        planes = composite(radiance, coverage, shade.tint, np.zeros(3))
        yield np.stack([quantize(plane)[0] for plane in planes], axis=-1)
