"""Which pixels to look at: those that can show the part, and those on an edge."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float, Float32, Int

AXES = 16  # directions in the image along which the part is bounded
MARGIN_PX = 0.01  # far above what float32 does to a pixel coordinate, 1e-4 px
FAINT = 0.03  # difference in light, 8 grey levels of a white part, that makes an edge
STRONG = 0.2  # difference above which five samples of a pixel are too few

LightAt = Callable[[Float32[np.ndarray, "n 2"]], Float32[np.ndarray, "n"]]


def may_show(
    points: Float[np.ndarray, "n 2"], side: int
) -> Bool[np.ndarray, "{side} {side}"]:
    """Pixels whose centre lies in the 32-gon around the projected `points`.

    A mesh lies in the convex hull of its vertices, and a central projection maps the hull of
    points before the camera onto the hull of their images.  So a ray outside the 32-gon,
    which contains that hull, cannot meet the mesh.
    """
    angle = (np.arange(AXES) + 0.5) * (np.pi / AXES)  # no axis is vertical: all bound u
    axes = np.stack([np.cos(angle), np.sin(angle)])
    along = points @ axes
    bounds = np.stack([along.min(axis=0) - MARGIN_PX, along.max(axis=0) + MARGIN_PX])
    centres = np.arange(side) + 0.5
    ends = np.sort((bounds - centres[:, None, None] * axes[1]) / axes[0], axis=1)
    left, right = ends[:, 0].max(axis=1), ends[:, 1].min(axis=1)
    return (centres >= left[:, None]) & (centres <= right[:, None])


def on_edge(
    depth: Float32[np.ndarray, "h w"], light: Float32[np.ndarray, "h w"], focal: float
) -> Bool[np.ndarray, "h w"]:
    """Pixels that differ from a neighbour above, below, left or right.

    They differ in light, by a silhouette or a crease, or jump in depth by more than the side of
    4 pixels.  Over the image of a plane 1/z is affine, however steep the plane, so that its
    second difference shows jumps and nothing else.
    """
    inverse = np.divide(1, depth, out=np.zeros_like(depth), where=depth > 0)
    edge = np.zeros(depth.shape, bool)
    for e, i, s in ((edge, inverse, light), (edge.T, inverse.T, light.T)):
        differs = np.abs(s[1:] - s[:-1]) > FAINT
        e[1:] |= differs
        e[:-1] |= differs
        e[1:-1] |= np.abs(i[2:] - 2 * i[1:-1] + i[:-2]) > (4 / focal) * i[1:-1]
    return edge


def pixel_means(
    light: Float32[np.ndarray, "side side"],
    edge: Int[np.ndarray, "edges"],
    light_at: LightAt,
    samples: int,
) -> tuple[Float32[np.ndarray, "side side"], Float32[np.ndarray, "side side"]]:
    """Mean over each pixel of the part's light, and of its cover.

    Beside an edge, a pixel's corners (each shared by four pixels) are looked at too.  Where they
    and the centre differ little, their mean serves; where they differ much, `samples` points do.
    """
    side = len(light)
    v, u = np.divmod(edge, side)
    corners = (v * (side + 1) + u)[:, None] + [0, 1, side + 1, side + 2]
    lattice = np.zeros((side + 1) ** 2, np.float32)
    needed = np.zeros(lattice.shape, bool)
    needed[corners] = True
    which = np.flatnonzero(needed)
    lattice[which] = light_at(np.stack(np.divmod(which, side + 1)[::-1], 1).astype(np.float32))
    few = np.concatenate([light.flat[edge][:, None].repeat(4, 1), lattice[corners]], axis=1)
    strong = np.ptp(few, axis=1) > STRONG
    centre = np.stack([u, v], axis=1)[strong].astype(np.float32)
    points = centre[:, None] + sample_pattern(samples).astype(np.float32)
    many = light_at(points.reshape(-1, 2)).reshape(-1, samples)
    mean, cover = np.maximum(light, 0), (light >= 0).astype(np.float32)
    for at, found in ((edge, few), (edge[strong], many)):
        mean.flat[at], cover.flat[at] = np.maximum(found, 0).mean(1), (found >= 0).mean(1)
    return mean, cover


def sample_pattern(n: int) -> Float[np.ndarray, "n 2"]:
    """`n` points of the unit square, one in each column and, for powers of 2, in each row.

    Hammersley's set, moved into the middle of its cells; no randomness.
    """
    bits = max(n - 1, 0).bit_length()
    mirrored = [int(f"{i:0{bits}b}"[::-1], 2) if bits else 0 for i in range(n)]
    return np.stack([(np.arange(n) + 0.5) / n, (np.array(mirrored) + 0.5) / 2**bits], axis=1)
