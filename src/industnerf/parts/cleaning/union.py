"""Closed bodies that overlap, united: no surface is left inside.  Only if asked."""

import manifold3d
import numpy as np
from jaxtyping import Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.cleaning.bodies import FILM, Body, bodies_of
from industnerf.parts.cleaning.edges import components
from industnerf.parts.cleaning.overlaps import described, overlaps_of, unsearched
from industnerf.parts.cleaning.selection import joined, kept, solid_of_faces
from industnerf.schema import CleanParams


def unite(solids: list[Mesh], settings: CleanParams) -> tuple[list[Mesh], list[str], list[str]]:
    """`solids`, and each group of overlapping bodies as one further solid that keeps finishes."""
    bodies = bodies_of(solids)
    overlaps = overlaps_of(bodies)
    if not settings.union or not len(overlaps.pairs):
        return solids, [], described(overlaps)
    group = components(overlaps.pairs, len(bodies))
    groups = [np.flatnonzero(group == number) for number in np.unique(group[overlaps.pairs])]
    whole = joined(solids)
    united = [_union([bodies[i] for i in members], whole) for members in groups]
    taken = np.concatenate([bodies[i].faces for members in groups for i in members])
    said = f"overlapping bodies united: {sum(map(len, groups))} to {len(united)}"
    return [*_without(solids, taken), *united], [said], unsearched(overlaps)


def _without(solids: list[Mesh], taken: Int[np.ndarray, "f"]) -> list[Mesh]:
    """`solids` less the faces `taken` of their joined mesh; solids that are then empty go."""
    owner = solid_of_faces(solids)
    left = np.ones(len(owner), bool)
    left[taken] = False
    stays = [left[owner == i] for i in range(len(solids))]
    return [kept(solid, which) for solid, which in zip(solids, stays, strict=True) if which.any()]


def _union(members: list[Body], whole: Mesh) -> Mesh:
    add = manifold3d.OpType.Add
    united = manifold3d.Manifold.batch_boolean([member.manifold for member in members], add)
    # Where surfaces coincide, a film can be left: a closed piece that holds nothing.
    pieces = [piece for piece in united.decompose() if piece.volume() > FILM]
    mesh = manifold3d.Manifold.compose(pieces).to_mesh64()
    # A face of the union remembers the face of `whole` from which it was cut.
    finish = whole.finish[np.asarray(mesh.face_id, np.int64)]
    return Mesh(mesh.vert_properties[:, :3].copy(), mesh.tri_verts.astype(np.int32), finish)
