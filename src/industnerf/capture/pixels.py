"""Which pixels to look at: those that can show the part, and those on an edge."""

import numpy as np
from jaxtyping import Bool, Float, Float32

AXES = 16  # directions in the image along which the part is bounded
MARGIN_PX = 0.01  # far above what float32 does to a pixel coordinate, 1e-4 px
CONTRAST = 0.03  # in irradiance: 8 grey levels of a white part


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
    depth: Float32[np.ndarray, "h w"], irradiance: Float32[np.ndarray, "h w"], focal: float
) -> Bool[np.ndarray, "h w"]:
    """Pixels that differ from a neighbour above, below, left or right."""
    inverse = np.zeros_like(depth)
    np.divide(1, depth, out=inverse, where=depth > 0)
    edge = np.zeros(depth.shape, bool)
    for e, i, s in ((edge, inverse, irradiance), (edge.T, inverse.T, irradiance.T)):
        differs = np.abs(s[1:] - s[:-1]) > CONTRAST
        e[1:] |= differs
        e[:-1] |= differs
        # Over the image of a plane 1/z is affine, however steep the plane: its second
        # difference shows jumps and nothing else.
        bend = np.abs(i[2:] - 2 * i[1:-1] + i[:-2]) * focal > 2 * i[1:-1]
        e[1:-1] |= bend
    return edge


def sample_pattern(n: int) -> Float[np.ndarray, "n 2"]:
    """`n` points of the unit square, one in each column and, for powers of 2, in each row.

    Hammersley's set, moved into the middle of its cells; no randomness.
    """
    bits = max(n - 1, 0).bit_length()
    mirrored = [int(f"{i:0{bits}b}"[::-1], 2) if bits else 0 for i in range(n)]
    return np.stack([(np.arange(n) + 0.5) / n, (np.array(mirrored) + 0.5) / 2**bits], axis=1)
