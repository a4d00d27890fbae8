"""Unit squares as triangle meshes, and points spread evenly over what they become."""

import numpy as np
from jaxtyping import Float, Int

from industnerf.geometry.sampling import sample_surface


def grid(side: int) -> tuple[Float[np.ndarray, "n 2"], Int[np.ndarray, "m 3"]]:
    """`side`^2 regular points of the unit square, its border included, and its triangles."""
    u, v = np.meshgrid(*2 * [np.linspace(0, 1, side)], indexing="ij")
    corner = np.arange(side * side).reshape(side, side)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    faces = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    return np.stack([u.ravel(), v.ravel()], axis=1), faces


def sample_patches(
    vertices: Float[np.ndarray, "patches n 3"],
    faces: Int[np.ndarray, "m 3"],
    count: int,
    rng: np.random.Generator,
) -> Float[np.ndarray, "count 3"]:
    """`count` area-uniform points of all patches together, which share their triangles.

    Patches may overlap; where they do there are more points, for nothing tells which one to drop.
    """
    vertex_offsets = np.arange(len(vertices))[:, None, None] * vertices.shape[1]
    return sample_surface(
        vertices.reshape(-1, 3), (faces + vertex_offsets).reshape(-1, 3), count, rng
    )[0]
