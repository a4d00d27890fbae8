"""Smaller images, by the mean over the area that each new pixel covers."""

import numpy as np
from jaxtyping import Float32, UInt8
from scipy.sparse import csr_array


def resize_area(
    image: UInt8[np.ndarray, "h w 3"], width: int, height: int
) -> UInt8[np.ndarray, "..."]:
    """`image` as `width` x `height` px, no larger than it was.

    A new pixel is the mean of the old ones, weighted by how much of each it covers, so that a
    plane stays a plane and no detail is skipped, whatever the ratio.
    """
    if image.shape[:2] == (height, width):
        return image
    rows = _area_average(image.astype(np.float32), height)
    resized = _area_average(rows.transpose(1, 0, 2), width).transpose(1, 0, 2)
    return np.rint(resized).astype(np.uint8)


def _area_average(image: Float32[np.ndarray, "a b c"], count: int) -> Float32[np.ndarray, "n b c"]:
    """Means along the first axis."""
    flat = area_weights(len(image), count) @ image.reshape(len(image), -1)
    return flat.reshape(count, *image.shape[1:])


def area_weights(old: int, new: int) -> csr_array:
    """(new, old): the share of each new pixel that each old one fills; rows sum to 1."""
    edges = np.arange(new + 1)[:, None] * (old / new)
    old_edges = np.arange(old)
    overlap = np.minimum(edges[1:], old_edges + 1) - np.maximum(edges[:-1], old_edges)
    return csr_array((np.maximum(overlap, 0) * (new / old)).astype(np.float32))
