"""A picture on a surface, brought down to one colour a face."""

import io

import numpy as np
from jaxtyping import Float, Float64
from PIL import Image

from industnerf.parts.reading.paint import linear

REMARK = "pictures on the surface reduced to one colour a face"
UNREADABLE = "a picture on the surface is missing or cannot be read"


def sampled(data: bytes, corners: Float[np.ndarray, "m 3 2"]) -> Float64[np.ndarray, "m 3"] | None:
    """The albedo at the middle of each face; None if `data` is no picture that can be read.

    `corners` are texture coordinates, v upwards; beyond [0, 1] the picture repeats.
    """
    try:
        with Image.open(io.BytesIO(data)) as picture:
            pixels = np.asarray(picture.convert("RGB"))
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return None
    height, width, _ = pixels.shape
    middle = np.nan_to_num(corners.mean(axis=1), posinf=0.0, neginf=0.0)
    column = (np.mod(middle[:, 0], 1.0) * width).astype(int).clip(0, width - 1)
    row = (np.mod(1 - middle[:, 1], 1.0) * height).astype(int).clip(0, height - 1)
    return linear(pixels[row, column].astype(np.float64) / 255)
