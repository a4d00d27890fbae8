"""The colour behind the part."""

import numpy as np
from jaxtyping import Float

from industnerf.capture.chance import Draws
from industnerf.schema import ViewsParams

LEVELS = {"white": 255, "grey": 128, "black": 0}


def backgrounds(settings: ViewsParams, draws: list[Draws]) -> Float[np.ndarray, "n 3"]:
    """The background of each view, in [0, 1].

    All are multiples of 1/255, so that a picture without noise shows them exactly.
    """
    if settings.background == "random":
        colours = [each.of("background").integers(0, 256, 3) for each in draws]
        return np.array(colours) / 255
    return np.full((len(draws), 3), LEVELS[settings.background] / 255)
