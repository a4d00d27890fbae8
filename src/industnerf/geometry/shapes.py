"""Surfaces that know nothing of a part but its bounding box, as area-uniform points.

`extents` are the side lengths of the box and `center` is its middle, both in mm.
"""

import numpy as np
from jaxtyping import Float

Vector = Float[np.ndarray, "3"]
Points = Float[np.ndarray, "n 3"]


def ball_surface(extents: Vector, center: Vector, n: int, rng: np.random.Generator) -> Points:
    """`n` points of the sphere whose diameter is the mean of the three extents."""
    towards = rng.standard_normal((n, 3))  # isotropic, hence uniform once of length 1
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    return center + extents.mean() / 2 * towards


def box_surface(extents: Vector, center: Vector, n: int, rng: np.random.Generator) -> Points:
    """`n` points of the six faces of the box.

    Raises ValueError if the box has no area, being a line or a point.
    """
    area = np.array([extents[1] * extents[2], extents[2] * extents[0], extents[0] * extents[1]])
    if not area.sum() > 0:
        raise ValueError(f"a box of {extents.tolist()} mm has no surface")
    points = rng.random((n, 3)) - 0.5
    normal = rng.choice(3, n, p=area / area.sum())
    points[np.arange(n), normal] = rng.choice([-0.5, 0.5], n)
    return center + extents * points
