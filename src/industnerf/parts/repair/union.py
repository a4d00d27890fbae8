"""Closed bodies that overlap, united: no surface is left inside.  Only if asked."""

import manifold3d
import numpy as np
from jaxtyping import Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.bodies import MIN_VOLUME, ClosedBody, closed_bodies
from industnerf.parts.repair.edges import component_labels
from industnerf.parts.repair.mesh_ops import concatenate, select_faces, solid_of_faces
from industnerf.parts.repair.overlaps import find_overlaps, overlap_warnings, unchecked_warnings
from industnerf.schema import RepairParams


def boolean_union(
    solids: list[Mesh], settings: RepairParams
) -> tuple[list[Mesh], list[str], list[str]]:
    """`solids`, and each group of overlapping bodies as one further solid that keeps finishes."""
    bodies = closed_bodies(solids)
    overlaps = find_overlaps(bodies)
    if not settings.boolean_union or not len(overlaps.pairs):
        return solids, [], overlap_warnings(overlaps)
    group = component_labels(overlaps.pairs, len(bodies))
    groups = [np.flatnonzero(group == number) for number in np.unique(group[overlaps.pairs])]
    whole = concatenate(solids)
    united = [_union([bodies[i] for i in members], whole) for members in groups]
    merged_faces = np.concatenate([bodies[i].faces for members in groups for i in members])
    message = f"overlapping bodies united: {sum(map(len, groups))} to {len(united)}"
    return [*_drop_faces(solids, merged_faces), *united], [message], unchecked_warnings(overlaps)


def _drop_faces(solids: list[Mesh], dropped: Int[np.ndarray, "f"]) -> list[Mesh]:
    """`solids` less the faces `taken` of their joined mesh; solids that are then empty go."""
    owner = solid_of_faces(solids)
    is_left = np.ones(len(owner), bool)
    is_left[dropped] = False
    kept_masks = [is_left[owner == i] for i in range(len(solids))]
    return [
        select_faces(solid, mask)
        for solid, mask in zip(solids, kept_masks, strict=True)
        if mask.any()
    ]


def _union(members: list[ClosedBody], whole: Mesh) -> Mesh:
    add = manifold3d.OpType.Add
    united = manifold3d.Manifold.batch_boolean([member.manifold for member in members], add)
    # Where surfaces coincide, a film can be left: a closed piece that holds nothing.
    pieces = [piece for piece in united.decompose() if piece.volume() > MIN_VOLUME]
    mesh = manifold3d.Manifold.compose(pieces).to_mesh64()
    # A face of the union remembers the face of `whole` from which it was cut.
    finish = whole.finish[np.asarray(mesh.face_id, np.int64)]
    return Mesh(mesh.vert_properties[:, :3].copy(), mesh.tri_verts.astype(np.int32), finish)
