"""Noise of a scan, smoothed away.  Off by default, because it rounds the edges of CAD."""

import numpy as np
from jaxtyping import Float
from scipy.sparse import csr_array

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.edges import build_edges
from industnerf.schema import RepairParams

SHRINK_STEP, GROW_STEP = 0.5, -0.53  # Taubin (1995): the second step undoes the shrinking


def smooth(solids: list[Mesh], settings: RepairParams) -> tuple[list[Mesh], list[str], list[str]]:
    """`solids` after `smooth_steps` Taubin steps; borders stay where they are."""
    if not settings.smooth_steps:
        return solids, [], []
    smoothed = [_smooth_solid(solid, settings.smooth_steps) for solid in solids]
    max_shift = max(
        float(np.linalg.norm(after.vertices - before.vertices, axis=1).max())
        for before, after in zip(solids, smoothed, strict=True)
    )
    message = f"vertices moved by up to {max_shift:.2%} of the diagonal"
    return smoothed, [f"smoothed in {settings.smooth_steps} steps: {message}"], []


def _smooth_solid(solid: Mesh, steps: int) -> Mesh:
    edges = build_edges(solid.faces)
    n = len(solid.vertices)
    a, b = edges.ends.T
    links = csr_array((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=(n, n))
    weight = 1 / np.maximum(links.sum(axis=1), 1)
    is_free = np.ones(n, bool)
    is_free[edges.ends[edges.face_count == 1]] = False
    vertices: Float[np.ndarray, "n 3"] = solid.vertices
    for _ in range(steps):
        for strength in (SHRINK_STEP, GROW_STEP):
            laplacian = weight[:, None] * (links @ vertices) - vertices
            vertices = vertices + strength * is_free[:, None] * laplacian
    return Mesh(vertices, solid.faces, solid.finish)
