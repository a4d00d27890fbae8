"""Random points of a triangle mesh, equally likely everywhere on its surface."""

import numpy as np
from jaxtyping import Float, Int


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
