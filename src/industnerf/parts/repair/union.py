"""Closed bodies that overlap, as a thread does its shank: reported, and united only if asked."""

from collections.abc import Iterator
from dataclasses import dataclass

import manifold3d
import numpy as np
from jaxtyping import Float, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.edges import component_labels
from industnerf.parts.repair.mesh_ops import concatenate, select_faces, solid_of_faces
from industnerf.parts.repair.shells import ContainmentTree, find_shells
from industnerf.schema import RepairParams

MIN_OVERLAP = (
    1e-3  # of the smaller body's volume; the facets of a pin and of its bore interlock by less
)
MAX_PAIRS = 500  # that are looked at, in order; a pair takes some 5 ms
MIN_VOLUME = 1e-12  # volume in cubed diagonals: a body with less is a surface folded onto itself


@dataclass(frozen=True)
class Overlaps:
    pairs: Int[np.ndarray, "p 2"]  # of bodies that overlap
    max_share: float  # the largest overlap, of the smaller body's volume
    num_unchecked: int  # pairs with boxes that overlap, beyond MAX_PAIRS


@dataclass(frozen=True)
class ClosedBody:
    """A closed, outward oriented shell and its cavities."""

    faces: Int[np.ndarray, "f"]  # of the joined mesh; the manifold's `face_id` names the same
    manifold: manifold3d.Manifold
    low: Float[np.ndarray, "3"]
    high: Float[np.ndarray, "3"]


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
    """`solids` less the faces `dropped` of their concatenation; solids left empty go."""
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


def find_overlaps(bodies: list[ClosedBody]) -> Overlaps:
    candidates = _candidate_pairs(bodies)
    shares = np.array([_overlap_share(bodies[a], bodies[b]) for a, b in candidates[:MAX_PAIRS]])
    return Overlaps(
        candidates[:MAX_PAIRS][shares > MIN_OVERLAP].reshape(-1, 2),
        float(shares.max(initial=0.0)),
        max(len(candidates) - MAX_PAIRS, 0),
    )


def overlap_warnings(overlaps: Overlaps) -> list[str]:
    """What to say if the bodies are left as they are."""
    messages = []
    if len(overlaps.pairs):
        messages.append(
            f"overlapping pairs of bodies: {len(overlaps.pairs)}, by up to "
            f"{overlaps.max_share:.1%} of the smaller (parts.repair.boolean_union unites them)"
        )
    return messages + unchecked_warnings(overlaps)


def unchecked_warnings(overlaps: Overlaps) -> list[str]:
    """What to say of the pairs that were not looked at, whatever became of the others."""
    if not overlaps.num_unchecked:
        return []
    return [
        f"pairs of bodies not searched for overlap: {overlaps.num_unchecked}, beyond the first "
        f"{MAX_PAIRS}"
    ]


def _candidate_pairs(bodies: list[ClosedBody]) -> Int[np.ndarray, "p 2"]:
    """Pairs of bodies whose boxes overlap."""
    if len(bodies) < 2:
        return np.empty((0, 2), np.int64)
    low, high = np.array([b.low for b in bodies]), np.array([b.high for b in bodies])
    rows = [
        np.column_stack([np.full(len(overlapping), i), overlapping])
        for i in range(len(bodies) - 1)
        for overlapping in [i + 1 + np.flatnonzero(_boxes_overlap(low, high, i))]
    ]
    return np.concatenate(rows)


def _boxes_overlap(
    low: Float[np.ndarray, "b 3"], high: Float[np.ndarray, "b 3"], i: int
) -> np.ndarray:
    """Whether the box of each body after the `i`th overlaps its box."""
    return ((low[i + 1 :] < high[i]) & (high[i + 1 :] > low[i])).all(axis=1)


def _overlap_share(a: ClosedBody, b: ClosedBody) -> float:
    intersection = manifold3d.Manifold.batch_boolean(
        [a.manifold, b.manifold], manifold3d.OpType.Intersect
    )
    # A body that crosses itself counts some of its room twice: no more than all is said.
    return min(intersection.volume() / min(a.manifold.volume(), b.manifold.volume()), 1.0)


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
