"""Area-uniform random points of surfaces: of a triangle mesh, a ball, a box."""

import numpy as np
from jaxtyping import Float, Int

Vector = Float[np.ndarray, "3"]
Points = Float[np.ndarray, "n 3"]


def sample_surface(
    vertices: Float[np.ndarray, "n 3"],
    faces: Int[np.ndarray, "m 3"],
    count: int,
    rng: np.random.Generator,
) -> tuple[Float[np.ndarray, "count 3"], Int[np.ndarray, "count"]]:
    """`count` independent area-uniform points (mm, float64) and the face that each lies on.

    Raises ValueError if the mesh has no area.
    """
    triangles = vertices.astype(np.float64)[faces]
    first, edges = triangles[:, 0], triangles[:, 1:] - triangles[:, :1]
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    total = area.sum()
    if not total > 0:
        raise ValueError(f"a mesh of {len(faces)} faces and no area has no surface to sample")
    face = rng.choice(len(faces), count, p=area / total)
    weights = rng.random((count, 2))
    is_folded = weights.sum(axis=1) > 1  # the other half of the parallelogram: turn it over
    weights[is_folded] = 1 - weights[is_folded]
    return first[face] + np.einsum("ni,nij->nj", weights, edges[face]), face


def ball_surface(extents: Vector, center: Vector, n: int, rng: np.random.Generator) -> Points:
    """`n` points (mm) of the sphere about `center` whose diameter is the mean of `extents` (mm)."""
    towards = rng.standard_normal((n, 3))  # isotropic, hence uniform once of length 1
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    return center + extents.mean() / 2 * towards


def box_surface(extents: Vector, center: Vector, n: int, rng: np.random.Generator) -> Points:
    """`n` points (mm) of the six faces of the box of sides `extents` (mm) about `center`.

    Raises ValueError if the box has no area, being a line or a point.
    """
    area = np.array([extents[1] * extents[2], extents[2] * extents[0], extents[0] * extents[1]])
    if not area.sum() > 0:
        raise ValueError(f"a box of {extents.tolist()} mm has no surface")
    points = rng.random((n, 3)) - 0.5
    normal = rng.choice(3, n, p=area / area.sum())
    points[np.arange(n), normal] = rng.choice([-0.5, 0.5], n)
    return center + extents * points
