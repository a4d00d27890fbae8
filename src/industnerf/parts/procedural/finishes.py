"""The finish of a procedural solid: one of the catalogue's, or a paint of any hue."""

from industnerf.parts.catalogue.appearances import APPEARANCES
from industnerf.parts.procedural.sampler import Sampler

MAX_ALBEDO = 0.72  # as of the catalogue's finishes: a lit face stays darker than the background
PAINT_SHARE = 0.25


def draw_albedo(rng: Sampler) -> tuple[float, float, float]:
    """A linear color in [0, `MAX_ALBEDO`]; batches of one finish differ a little in brightness."""
    if rng.chance(PAINT_SHARE):
        strong, weak = rng.uniform(0.25, 0.6), rng.uniform(0.06, 0.2)
        levels = (strong, rng.uniform(weak, strong), weak)
        color = [levels[i] for i in rng.order(3)]
    else:
        color = list(rng.pick(list(APPEARANCES.values())).albedo or (0.5, 0.5, 0.5))
    brightness = rng.uniform(0.85, 1.15)
    red, green, blue = (min(MAX_ALBEDO, brightness * level) for level in color)
    return red, green, blue
