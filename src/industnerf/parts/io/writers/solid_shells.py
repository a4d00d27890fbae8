"""Which closed surfaces of a mesh bound one solid: an outer one, and the voids inside it."""

import numpy as np
from jaxtyping import Int32

from industnerf.artifacts.part import Mesh
from industnerf.parts.validation import checks


def group_shells_by_solid(mesh: Mesh) -> list[list[Int32[np.ndarray, "k"]]]:
    """For each solid the faces of its shells, the outer one first.

    A shell of negative volume is a void of the smallest solid whose box holds it.
    """
    shells = _shells(mesh.faces)
    volumes = [checks.volume_mm3(mesh.vertices, mesh.faces[shell]) for shell in shells]
    ordered = sorted(zip(volumes, shells, strict=True), key=lambda pair: pair[0])
    solids = [[shell] for volume, shell in ordered if volume > 0]  # the smallest first
    for cavity in (shell for volume, shell in ordered if volume <= 0):
        containing = [solid for solid in solids if _box_contains(mesh, solid[0], cavity)]
        (containing or solids)[0].append(cavity)
    return solids


def _shells(faces: Int32[np.ndarray, "m 3"]) -> list[Int32[np.ndarray, "k"]]:
    piece = checks.surface_components(faces)
    return [np.flatnonzero(piece == each).astype(np.int32) for each in np.unique(piece)]


def _box_contains(mesh: Mesh, outer: Int32[np.ndarray, "k"], inner: Int32[np.ndarray, "j"]) -> bool:
    outer_points, inner_points = (mesh.triangles[faces].reshape(-1, 3) for faces in (outer, inner))
    return bool(
        (
            (outer_points.min(0) <= inner_points.min(0))
            & (inner_points.max(0) <= outer_points.max(0))
        ).all()
    )
