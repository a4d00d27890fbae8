"""The color behind the part."""

import numpy as np
from jaxtyping import Float

from industnerf.capture.rng import RandomStreams
from industnerf.schema import ViewsParams

LEVELS = {"white": 255, "gray": 128, "black": 0}


def backgrounds(
    settings: ViewsParams, view_streams: list[RandomStreams]
) -> Float[np.ndarray, "n 3"]:
    """The background of each view, in [0, 1].

    All are multiples of 1/255, so that a picture without noise shows them exactly.
    """
    if settings.background == "random":
        colors = [streams.generator("background").integers(0, 256, 3) for streams in view_streams]
        return np.array(colors) / 255
    return np.full((len(view_streams), 3), LEVELS[settings.background] / 255)
