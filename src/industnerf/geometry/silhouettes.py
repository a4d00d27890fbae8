"""Silhouettes from colour, and how far each pixel is from their outline."""

from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float, Float32, UInt8

NEAR = 11  # px; distances are exact up to here, and NEAR^2 + (NEAR - 1)^2 fits 8 bits
TOUCHED = 0.5  # px; a pixel that shows any of the part lies on average half outside it


def differs(
    rgb: UInt8[np.ndarray, "n h w 3"], background: Float[np.ndarray, "n 3"], tolerance: float
) -> Bool[np.ndarray, "n h w"]:
    """Whether any channel is farther than `tolerance` from its view's background, in [0, 1]."""
    level = np.arange(256)[:, None] / 255
    masks = np.zeros(rgb.shape[:3], bool)
    for mask, picture, colour in zip(masks, rgb, background, strict=True):
        table = np.abs(level - colour) > tolerance
        for channel in range(3):
            mask |= table[picture[..., channel], channel]
    return masks


def signed_distance(mask: Bool[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """Distance (px) to the outline, which runs half-way between unlike pixels."""
    half = np.float32(0.5)
    return np.where(mask, to_nearest(~mask) - half, half - to_nearest(mask))


def to_nearest(target: Bool[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """Distance (px) from every pixel's centre to that of the nearest `target`, at most NEAR.

    Euclidean and exact, along the columns and then along the rows: squared distance separates
    -- Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled Functions" (2012).
    """
    column = np.where(target, np.uint8(0), np.uint8(NEAR))
    for downwards in (column, column[::-1]):
        for above, here in pairwise(downwards):
            np.minimum(here, above + np.uint8(1), out=here)
    square = column * column
    best = square.copy()
    for step in range(1, NEAR):
        aside = square + np.uint8(step * step)
        np.minimum(best[:, step:], aside[:, :-step], out=best[:, step:])
        np.minimum(best[:, :-step], aside[:, step:], out=best[:, :-step])
    return np.sqrt(np.arange(256, dtype=np.float32))[best]
