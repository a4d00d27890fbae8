"""A picture on a surface, brought down to one color a face."""

import io

import numpy as np
from jaxtyping import Float, Float64
from PIL import Image

from industnerf.parts.io.readers.colors import srgb_to_linear

REDUCED_WARNING = "pictures on the surface reduced to one color a face"
UNREADABLE_WARNING = "a picture on the surface is missing or cannot be read"


def sample_texture(
    data: bytes, corners: Float[np.ndarray, "m 3 2"]
) -> Float64[np.ndarray, "m 3"] | None:
    """The albedo at the middle of each face; None if `data` is no picture that can be read.

    `corners` are texture coordinates, v upwards; beyond [0, 1] the picture repeats.
    """
    try:
        with Image.open(io.BytesIO(data)) as image:
            pixels = np.asarray(image.convert("RGB"))
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return None
    height, width, _ = pixels.shape
    uv = np.nan_to_num(corners.mean(axis=1), posinf=0.0, neginf=0.0)
    column = (np.mod(uv[:, 0], 1.0) * width).astype(int).clip(0, width - 1)
    row = (np.mod(1 - uv[:, 1], 1.0) * height).astype(int).clip(0, height - 1)
    return srgb_to_linear(pixels[row, column].astype(np.float64) / 255)
