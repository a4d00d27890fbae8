"""Photographs as nets take them: fewer and smaller."""

import numpy as np
from jaxtyping import Int, UInt8


def evenly_spaced_indices(total: int, count: int) -> Int[np.ndarray, "_"]:
    """At most `count` of the indices below `total`, evenly spread, the first among them."""
    count = min(count, total)
    return np.arange(count) * total // count


def resize_images(
    images: UInt8[np.ndarray, "n h w 3"], px: int
) -> UInt8[np.ndarray, "n {px} {px} 3"]:
    """`images` at `px` a side, every pixel the mean of those whose centers it covers."""
    from PIL import Image

    resized = [Image.fromarray(one).resize((px, px), Image.Resampling.BOX) for one in images]
    return np.stack([np.asarray(one) for one in resized])
