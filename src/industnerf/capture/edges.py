"""Anti-aliasing where it shows: which pixels lie on an edge, and their mean over the pixel.

Radiance has one channel or three, as the shading returns it; BACKGROUND stands where no part is.
Image coordinates (u, v) are in px, as everywhere.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float32, Int

BACKGROUND = np.float32(-1)  # darker than anything, so that a silhouette is an edge in radiance
EDGE_THRESHOLD = 0.03  # difference in radiance, 8 gray levels of a white part, that makes an edge
# spread in radiance within a pixel for which its corners and center are too few samples
SUPERSAMPLE_THRESHOLD = 0.2
DEPTH_JUMP_PX = 4  # jump in depth, in sides of a pixel, that makes an edge

Radiance = Float32[np.ndarray, "channels n"]
RadianceAt = Callable[[Float32[np.ndarray, "n 2"]], Radiance]


def edge_mask(
    depth: Float32[np.ndarray, "h w"], radiance: Float32[np.ndarray, "channels h w"], focal: float
) -> Bool[np.ndarray, "h w"]:
    """Pixels that differ from a neighbor above, below, left or right; depth 0 is background.

    They differ in radiance, across a silhouette, a crease or a change of color, or they jump in
    depth.  Over the image of a plane 1/z is affine, however steep the plane, so its second
    difference shows jumps only.
    """
    inverse = np.divide(1, depth, out=np.zeros_like(depth), where=depth > 0)
    edge = np.zeros(depth.shape, bool)
    transposed = radiance.transpose(0, 2, 1)
    for e, i, planes in ((edge, inverse, radiance), (edge.T, inverse.T, transposed)):
        for s in planes:
            differs = np.abs(s[1:] - s[:-1]) > EDGE_THRESHOLD
            e[1:] |= differs
            e[:-1] |= differs
        e[1:-1] |= np.abs(i[2:] - 2 * i[1:-1] + i[:-2]) > (DEPTH_JUMP_PX / focal) * i[1:-1]
    return edge


def pixel_means(
    radiance: Float32[np.ndarray, "channels h w"],
    edge_ids: Int[np.ndarray, "edges"],
    radiance_at: RadianceAt,
    num_samples: int,
    top_left: tuple[int, int] = (0, 0),
) -> tuple[Float32[np.ndarray, "channels h w"], Float32[np.ndarray, "h w"]]:
    """Mean over each pixel of the part's radiance, and of its coverage.

    `radiance` is that of the pixel centers in a window of the image, whose first pixel is
    `top_left` (row, column); `edge_ids` are the flat indices of the window's pixels on an edge.
    Of those the corners are sampled too: four pixels share each.  Where corners and center differ
    little they give the mean, and where they differ much `num_samples` further points do.
    """
    channels, _, width = radiance.shape
    v, u = np.divmod(edge_ids, width)
    u, v = u + top_left[1], v + top_left[0]
    centers = radiance.reshape(channels, -1).take(edge_ids, axis=1)
    corners = corner_radiance(u, v, radiance_at)
    highest = np.maximum(corners.max(axis=1), centers)
    lowest = np.minimum(corners.min(axis=1), centers)
    has_contrast = (highest - lowest > SUPERSAMPLE_THRESHOLD).any(axis=0)
    points = sample_points(u[has_contrast], v[has_contrast], num_samples)
    samples = radiance_at(points).reshape(channels, -1, num_samples)

    mean, coverage = np.maximum(radiance, 0), (radiance[0] >= 0).astype(np.float32)
    first, second, third, fourth = np.maximum(corners, 0).swapaxes(0, 1)
    # Half the weight on the center: right on average for an edge along the pixel's side.
    coarse_means = (4 * np.maximum(centers, 0) + ((first + second) + (third + fourth))) / 8
    fine_means, contrast_ids = np.maximum(samples, 0).mean(axis=2), edge_ids[has_contrast]
    for plane, coarse, fine in zip(mean, coarse_means, fine_means, strict=True):
        plane.flat[edge_ids] = coarse
        plane.flat[contrast_ids] = fine
    coverage.flat[edge_ids] = (4 * (centers[0] >= 0) + (corners[0] >= 0).sum(axis=0)) / 8
    coverage.flat[contrast_ids] = (samples[0] >= 0).mean(axis=1)
    return mean, coverage


def corner_radiance(
    u: Int[np.ndarray, "n"], v: Int[np.ndarray, "n"], radiance_at: RadianceAt
) -> Float32[np.ndarray, "channels 4 n"]:
    """Radiance at the corners of the pixels (u, v), each corner sampled once.

    Rays are fast where they follow their neighbors, so corners come by tiles of 8 x 8.
    """
    column, row = np.stack([u, u + 1, u, u + 1]), np.stack([v, v, v + 1, v + 1])
    tiles_across = int(column.max(initial=0)) // 8 + 1
    tile = (row >> 3) * tiles_across + (column >> 3)
    corner_ids = tile << 6 | (row & 7) << 3 | column & 7
    is_needed = np.zeros(int(corner_ids.max(initial=0)) + 1, bool)
    is_needed[corner_ids] = True
    needed_ids = np.flatnonzero(is_needed)
    tile_row, tile_column = np.divmod(needed_ids >> 6, tiles_across)
    needed = tile_column << 3 | needed_ids & 7, tile_row << 3 | needed_ids >> 3 & 7
    values = radiance_at(np.stack(needed, axis=1).astype(np.float32))
    position = np.cumsum(is_needed, dtype=np.int32) - 1
    return values.take(position.take(corner_ids), axis=1)


def sample_points(
    u: Int[np.ndarray, "n"], v: Int[np.ndarray, "n"], num_samples: int
) -> Float32[np.ndarray, "n*{num_samples} 2"]:
    """Image coordinates of the samples of the pixels (u, v), pixel by pixel."""
    points = np.empty((len(u), num_samples, 2), np.float32)
    for axis, offsets in enumerate(hammersley_points(num_samples).T):
        np.add.outer((u, v)[axis].astype(np.float32), offsets, out=points[..., axis])
    return points.reshape(-1, 2)


def hammersley_points(n: int) -> Float32[np.ndarray, "n 2"]:
    """`n` points of the unit square: one in each column and, for powers of 2, in each row.

    Hammersley's set, moved into the middle of its cells; no randomness.
    """
    bits = (n - 1).bit_length()
    bit_reversed = [
        sum((i >> bit & 1) << (bits - 1 - bit) for bit in range(bits)) for i in range(n)
    ]
    points = np.stack([(np.arange(n) + 0.5) / n, (np.array(bit_reversed) + 0.5) / 2**bits], axis=1)
    return points.astype(np.float32)
