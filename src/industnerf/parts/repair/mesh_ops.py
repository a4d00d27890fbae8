"""Selections and unions of meshes, and the normalization in which the repair works.

Order is kept, and vertices that no face uses go.  Normalized, the box is centered and has a
diagonal of 1.  Tolerances are then plain numbers, and neither a part of 1e-6 mm nor one 1e7 mm
from the origin loses a digit of its file.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart


@dataclass(frozen=True)
class Normalization:
    center: Float[np.ndarray, "3"]  # mm
    diagonal: float  # mm

    def normalize(self, mesh: Mesh) -> Mesh:
        """`mesh` from mm to diagonals about the center."""
        return Mesh((mesh.vertices - self.center) / self.diagonal, mesh.faces, mesh.finish)

    def denormalize(self, mesh: Mesh) -> Mesh:
        """The inverse of `normalize`, up to rounding by 2e-16 of the coordinate."""
        return Mesh(mesh.vertices * self.diagonal + self.center, mesh.faces, mesh.finish)


def drop_unused_vertices(mesh: Mesh) -> Mesh:
    """`mesh` without the vertices that no face uses."""
    used = np.zeros(len(mesh.vertices), bool)
    used[mesh.faces] = True
    if used.all():
        return mesh
    renumbered = (np.cumsum(used) - 1).astype(np.int32)
    return Mesh(mesh.vertices[used], renumbered[mesh.faces], mesh.finish)


def select_faces(mesh: Mesh, mask: Bool[np.ndarray, "m"]) -> Mesh:
    """The faces of `mesh` that `mask` marks."""
    if mask.all():
        return mesh
    return drop_unused_vertices(Mesh(mesh.vertices, mesh.faces[mask], mesh.finish[mask]))


def concatenate(solids: Sequence[Mesh]) -> Mesh:
    """One mesh of all `solids`, at least one; they share no vertex."""
    first = np.cumsum([0, *(len(solid.vertices) for solid in solids[:-1])])
    return Mesh(
        np.concatenate([solid.vertices for solid in solids]),
        np.concatenate(
            [s.faces + np.int32(offset) for s, offset in zip(solids, first, strict=True)],
            dtype=np.int32,
        ),
        np.concatenate([solid.finish for solid in solids]),
    )


def solid_of_faces(solids: Sequence[Mesh]) -> Int[np.ndarray, "m"]:
    """The number of the solid from which each face of `concatenate(solids)` comes."""
    return np.repeat(np.arange(len(solids)), [len(solid.faces) for solid in solids])


def replace_faces(solids: Sequence[Mesh], faces: Int[np.ndarray, "m 3"]) -> list[Mesh]:
    """`solids` with the `faces` of their concatenation, whose corners were reordered."""
    vertex, face = 0, 0
    replaced = []
    for solid in solids:
        corners = faces[face : face + len(solid.faces)] - vertex
        replaced.append(Mesh(solid.vertices, corners.astype(np.int32), solid.finish))
        vertex, face = vertex + len(solid.vertices), face + len(solid.faces)
    return replaced


def format_share(share: float) -> str:
    """`share` in percent, and never as nothing."""
    return f"{share:.2%}" if share >= 5e-5 else "less than 0.01%"


def fit_normalization(solids: list[Mesh]) -> Normalization:
    """The normalization of finite `solids` without unused vertices; BadPart if they are a point."""
    low = np.min([solid.vertices.min(axis=0) for solid in solids], axis=0)
    high = np.max([solid.vertices.max(axis=0) for solid in solids], axis=0)
    with np.errstate(over="ignore"):  # an infinite diagonal is refused below
        diagonal = math.hypot(*(high - low))
    if not 0 < diagonal < math.inf:
        raise BadPart(f"its bounding box has a diagonal of {diagonal:g} mm")
    return Normalization(low + (high - low) / 2, diagonal)
