"""The closed bodies of a mesh, each with the cavities in it, as manifolds."""

from collections.abc import Iterator
from dataclasses import dataclass

import manifold3d
import numpy as np
from jaxtyping import Float, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.cleaning.inside import Nest
from industnerf.parts.cleaning.selection import joined, solid_of_faces
from industnerf.parts.cleaning.shells import shells_of

FILM = 1e-12  # volume in cubed diagonals: a body with less is a surface folded onto itself


@dataclass(frozen=True)
class Body:
    """A closed, outward oriented shell and its cavities."""

    faces: Int[np.ndarray, "f"]  # of the joined mesh; the manifold's `face_id` names the same
    manifold: manifold3d.Manifold
    low: Float[np.ndarray, "3"]
    high: Float[np.ndarray, "3"]


def bodies_of(solids: list[Mesh]) -> list[Body]:
    """The bodies of `solids`; what is open, wound both ways or inside out is in none."""
    whole = joined(solids)
    shells = shells_of(whole)
    nest = Nest(whole, shells)
    solid = solid_of_faces(solids)[np.unique(shells.of_face, return_index=True)[1]]
    sound = shells.closed & (shells.sums(shells.odd) == 0)
    outer = np.flatnonzero(sound & (shells.volume > 0))
    parts = {int(shell): [int(shell)] for shell in outer}
    for cavity in np.flatnonzero(sound & (shells.volume < 0)):
        holders = nest.holders(int(cavity), outer[solid[outer] == solid[cavity]])
        if holders:
            parts[min(holders, key=lambda shell: shells.volume[shell])].append(int(cavity))
    return list(_manifolds(whole, nest, parts))


def _manifolds(whole: Mesh, nest: Nest, parts: dict[int, list[int]]) -> Iterator[Body]:
    for shell, members in parts.items():
        faces = np.concatenate([nest.faces[member] for member in members])
        used, corners = np.unique(whole.faces[faces], return_inverse=True)
        mesh = manifold3d.Mesh64(
            whole.vertices[used],
            np.ascontiguousarray(corners.reshape(-1, 3), np.uint64),
            face_id=faces.astype(np.uint64),
        )
        manifold = manifold3d.Manifold(mesh)
        if manifold.status() == manifold3d.Error.NoError and manifold.volume() > FILM:
            yield Body(faces, manifold, nest.low[shell], nest.high[shell])
