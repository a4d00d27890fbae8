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
    radiance: Float32[np.ndarray, "channels side side"],
    edge_ids: Int[np.ndarray, "edges"],
    radiance_at: RadianceAt,
    num_samples: int,
) -> tuple[Float32[np.ndarray, "channels side side"], Float32[np.ndarray, "side side"]]:
    """Mean over each pixel of the part's radiance, and of its coverage.

    `radiance` is that of the pixel centers, `edge_ids` are the flat indices of the pixels on an
    edge.  Of those the corners are sampled too: four pixels share each.  Where corners and center
    differ little they give the mean, and where they differ much `num_samples` further points do.
    """
    side = radiance.shape[-1]
    v, u = np.divmod(edge_ids, side)
    centers = radiance.reshape(len(radiance), -1)[:, edge_ids]
    # Half the weight on the center: right on average for an edge along the pixel's side.
    corner_samples = np.concatenate(
        [np.repeat(centers[..., None], 4, axis=2), corner_radiance(u, v, side, radiance_at)], axis=2
    )
    has_contrast = (np.ptp(corner_samples, axis=2) > SUPERSAMPLE_THRESHOLD).any(axis=0)
    contrast_pixels = np.stack([u, v], axis=1)[has_contrast].astype(np.float32)
    points = (contrast_pixels[:, None] + hammersley_points(num_samples)).reshape(-1, 2)
    fine_samples = radiance_at(points).reshape(len(radiance), -1, num_samples)
    mean, coverage = np.maximum(radiance, 0), (radiance[0] >= 0).astype(np.float32)
    for ids, estimates in ((edge_ids, corner_samples), (edge_ids[has_contrast], fine_samples)):
        for plane, values in zip(mean, np.maximum(estimates, 0).mean(axis=2), strict=True):
            plane.flat[ids] = values
        coverage.flat[ids] = (estimates[0] >= 0).mean(axis=1)
    return mean, coverage


def corner_radiance(
    u: Int[np.ndarray, "n"], v: Int[np.ndarray, "n"], side: int, radiance_at: RadianceAt
) -> Float32[np.ndarray, "channels n 4"]:
    """Radiance at the corners of the pixels (u, v), each corner sampled once."""
    corners = ((side + 1) * v + u)[:, None] + [0, 1, side + 1, side + 2]
    needed = np.zeros((side + 1) ** 2, bool)
    needed[corners] = True
    needed_ids = np.flatnonzero(needed)
    rows, columns = np.divmod(needed_ids, side + 1)
    needed_values = radiance_at(np.stack([columns, rows], axis=1).astype(np.float32))
    corner_values = np.empty((len(needed_values), len(needed)), np.float32)
    corner_values[:, needed_ids] = needed_values
    return corner_values[:, corners]


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
