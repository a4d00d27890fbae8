"""Anti-aliasing where it shows: which pixels lie on an edge, and their mean over the pixel.

`light` is what a shader says, in one channel or three; BACKGROUND stands where there is none.
Image coordinates (u, v) are in px, as everywhere.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float32, Int

BACKGROUND = np.float32(-1)  # darker than anything, so that a silhouette is an edge in light
FAINT = 0.03  # difference in light, 8 grey levels of a white part, that makes an edge
STRONG = 0.2  # spread in light within a pixel for which its corners and centre are too few
DEEP_PX = 4  # jump in depth, in sides of a pixel, that makes an edge

Light = Float32[np.ndarray, "channels n"]
LightAt = Callable[[Float32[np.ndarray, "n 2"]], Light]


def on_edge(
    depth: Float32[np.ndarray, "h w"], light: Float32[np.ndarray, "channels h w"], focal: float
) -> Bool[np.ndarray, "h w"]:
    """Pixels that differ from a neighbour above, below, left or right; depth 0 is background.

    They differ in light, across a silhouette, a crease or a change of colour, or they jump in
    depth.  Over the image of a plane 1/z is affine, however steep the plane, so its second
    difference shows jumps only.
    """
    inverse = np.divide(1, depth, out=np.zeros_like(depth), where=depth > 0)
    edge = np.zeros(depth.shape, bool)
    turned = light.transpose(0, 2, 1)
    for e, i, planes in ((edge, inverse, light), (edge.T, inverse.T, turned)):
        for s in planes:
            differs = np.abs(s[1:] - s[:-1]) > FAINT
            e[1:] |= differs
            e[:-1] |= differs
        e[1:-1] |= np.abs(i[2:] - 2 * i[1:-1] + i[:-2]) > (DEEP_PX / focal) * i[1:-1]
    return edge


def pixel_means(
    light: Float32[np.ndarray, "channels side side"],
    edge: Int[np.ndarray, "edges"],
    light_at: LightAt,
    samples: int,
) -> tuple[Float32[np.ndarray, "channels side side"], Float32[np.ndarray, "side side"]]:
    """Mean over each pixel of the part's light, and of its cover.

    `light` holds the pixel centres, `edge` the flat indices of the pixels on an edge.  Of those
    the corners are looked at too: four pixels share each.  Where corners and centre differ
    little they give the mean, and where they differ much `samples` further points do.
    """
    side = light.shape[-1]
    v, u = np.divmod(edge, side)
    centres = light.reshape(len(light), -1)[:, edge]
    # Half the weight on the centre: right on average for an edge along the pixel's side.
    few = np.concatenate(
        [np.repeat(centres[..., None], 4, axis=2), corner_light(u, v, side, light_at)], axis=2
    )
    strong = (np.ptp(few, axis=2) > STRONG).any(axis=0)
    first = np.stack([u, v], axis=1)[strong].astype(np.float32)
    points = (first[:, None] + sample_pattern(samples)).reshape(-1, 2)
    many = light_at(points).reshape(len(light), -1, samples)
    mean, cover = np.maximum(light, 0), (light[0] >= 0).astype(np.float32)
    for where, found in ((edge, few), (edge[strong], many)):
        for plane, values in zip(mean, np.maximum(found, 0).mean(axis=2), strict=True):
            plane.flat[where] = values
        cover.flat[where] = (found[0] >= 0).mean(axis=1)
    return mean, cover


def corner_light(
    u: Int[np.ndarray, "n"], v: Int[np.ndarray, "n"], side: int, light_at: LightAt
) -> Float32[np.ndarray, "channels n 4"]:
    """Light at the corners of the pixels (u, v), each corner looked at once."""
    corners = ((side + 1) * v + u)[:, None] + [0, 1, side + 1, side + 2]
    needed = np.zeros((side + 1) ** 2, bool)
    needed[corners] = True
    which = np.flatnonzero(needed)
    below, along = np.divmod(which, side + 1)
    found = light_at(np.stack([along, below], axis=1).astype(np.float32))
    lattice = np.empty((len(found), len(needed)), np.float32)
    lattice[:, which] = found
    return lattice[:, corners]


def sample_pattern(n: int) -> Float32[np.ndarray, "n 2"]:
    """`n` points of the unit square: one in each column and, for powers of 2, in each row.

    Hammersley's set, moved into the middle of its cells; no randomness.
    """
    bits = (n - 1).bit_length()
    mirrored = [sum((i >> bit & 1) << (bits - 1 - bit) for bit in range(bits)) for i in range(n)]
    points = np.stack([(np.arange(n) + 0.5) / n, (np.array(mirrored) + 0.5) / 2**bits], axis=1)
    return points.astype(np.float32)
