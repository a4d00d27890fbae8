"""Parts of meshes, and meshes put together; order is kept, and vertices that no face uses go."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Int

from industnerf.artifacts.part import Mesh


def drop_unused_vertices(mesh: Mesh) -> Mesh:
    """`mesh` without the vertices that no face uses."""
    used = np.zeros(len(mesh.vertices), bool)
    used[mesh.faces] = True
    if used.all():
        return mesh
    renumbered = (np.cumsum(used) - 1).astype(np.int32)
    return Mesh(mesh.vertices[used], renumbered[mesh.faces], mesh.finish)


def select_faces(mesh: Mesh, mask: Bool[np.ndarray, "m"]) -> Mesh:
    """The faces of `mesh` that `which` marks."""
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
    """The number of the solid from which each face of `joined(solids)` comes."""
    return np.repeat(np.arange(len(solids)), [len(solid.faces) for solid in solids])


def replace_faces(solids: Sequence[Mesh], faces: Int[np.ndarray, "m 3"]) -> list[Mesh]:
    """`solids` with the faces of their `joined` mesh replaced, each with its corners reordered."""
    vertex, face = 0, 0
    replaced = []
    for solid in solids:
        corners = faces[face : face + len(solid.faces)] - vertex
        replaced.append(Mesh(solid.vertices, corners.astype(np.int32), solid.finish))
        vertex, face = vertex + len(solid.vertices), face + len(solid.faces)
    return replaced
