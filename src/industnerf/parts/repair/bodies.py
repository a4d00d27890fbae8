"""The closed bodies of a mesh, each with the cavities in it, as manifolds."""

from collections.abc import Iterator
from dataclasses import dataclass

import manifold3d
import numpy as np
from jaxtyping import Float, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.containment import ContainmentTree
from industnerf.parts.repair.mesh_ops import concatenate, solid_of_faces
from industnerf.parts.repair.shells import find_shells

MIN_VOLUME = 1e-12  # volume in cubed diagonals: a body with less is a surface folded onto itself


@dataclass(frozen=True)
class ClosedBody:
    """A closed, outward oriented shell and its cavities."""

    faces: Int[np.ndarray, "f"]  # of the joined mesh; the manifold's `face_id` names the same
    manifold: manifold3d.Manifold
    low: Float[np.ndarray, "3"]
    high: Float[np.ndarray, "3"]


def closed_bodies(solids: list[Mesh]) -> list[ClosedBody]:
    """The bodies of `solids`; what is open, wound both ways or inside out is in none."""
    whole = concatenate(solids)
    shells = find_shells(whole)
    containment = ContainmentTree(whole, shells)
    solid = solid_of_faces(solids)[np.unique(shells.shell_of_face, return_index=True)[1]]
    is_sound = shells.is_closed & (shells.sum_per_shell(shells.is_minority) == 0)
    outer = np.flatnonzero(is_sound & (shells.volume > 0))
    shells_of_body = {int(shell): [int(shell)] for shell in outer}
    for cavity in np.flatnonzero(is_sound & (shells.volume < 0)):
        containing = containment.containing_shells(
            int(cavity), outer[solid[outer] == solid[cavity]]
        )
        if containing:
            shells_of_body[min(containing, key=lambda shell: shells.volume[shell])].append(
                int(cavity)
            )
    return list(_manifolds(whole, containment, shells_of_body))


def _manifolds(
    whole: Mesh, containment: ContainmentTree, shells_of_body: dict[int, list[int]]
) -> Iterator[ClosedBody]:
    for shell, members in shells_of_body.items():
        faces = np.concatenate([containment.faces[member] for member in members])
        used_vertices, corners = np.unique(whole.faces[faces], return_inverse=True)
        mesh = manifold3d.Mesh64(
            whole.vertices[used_vertices],
            np.ascontiguousarray(corners.reshape(-1, 3), np.uint64),
            face_id=faces.astype(np.uint64),
        )
        manifold = manifold3d.Manifold(mesh)
        if manifold.status() == manifold3d.Error.NoError and manifold.volume() > MIN_VOLUME:
            yield ClosedBody(faces, manifold, containment.low[shell], containment.high[shell])
