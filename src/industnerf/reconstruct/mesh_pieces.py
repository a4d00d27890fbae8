"""The pieces of a closed mesh: how many solids there are, and the largest of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import trimesh
from jaxtyping import Float, Int64

FACES_AT_ONCE = 200_000  # of a winding number, for the memory that it takes


@dataclass(frozen=True)
class Piece:
    """One solid: the faces of its outside, and of the cavities in it."""

    faces: Int64[np.ndarray, "n"]
    volume: float  # without its cavities


def split_pieces(mesh: trimesh.Trimesh) -> list[Piece]:
    """The solids of a closed `mesh`, the largest first; a cavity belongs to the solid around it."""
    shells = trimesh.graph.connected_components(
        mesh.face_adjacency, nodes=np.arange(len(mesh.faces)), min_len=1
    )
    corners = mesh.triangles - mesh.triangles.mean(axis=(0, 1))
    signed = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    volumes = [float(signed[shell].sum()) for shell in shells]
    outsides = sorted(
        (index for index, volume in enumerate(volumes) if volume > 0), key=lambda i: -volumes[i]
    )
    faces, totals = {i: [shells[i]] for i in outsides}, {i: volumes[i] for i in outsides}
    for index, volume in enumerate(volumes):
        if volume > 0:
            continue
        point = mesh.vertices[mesh.faces[shells[index][0], 0]]
        around = [i for i in outsides if winding_number(mesh.triangles[shells[i]], point) > 0.5]
        if around:  # the last of them is the smallest, so the innermost
            faces[around[-1]].append(shells[index])
            totals[around[-1]] += volume
    pieces = [Piece(np.concatenate(faces[i]).astype(np.int64), totals[i]) for i in outsides]
    return sorted(pieces, key=lambda piece: -piece.volume)


def winding_number(triangles: Float[np.ndarray, "n 3 3"], point: Float[np.ndarray, "3"]) -> float:
    """How often the closed `triangles` wind about `point`: 1 inside, 0 outside.

    The sum of their solid angles over 4 pi -- van Oosterom and Strackee, "The Solid Angle of a
    Plane Triangle" (1983).
    """
    total = 0.0
    for start in range(0, len(triangles), FACES_AT_ONCE):
        a, b, c = (triangles[start : start + FACES_AT_ONCE] - point).transpose(1, 0, 2)
        length_a, length_b, length_c = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        numerator = np.einsum("ij,ij->i", a, np.cross(b, c))
        denominator = (
            length_a * length_b * length_c
            + np.einsum("ij,ij->i", a, b) * length_c
            + np.einsum("ij,ij->i", b, c) * length_a
            + np.einsum("ij,ij->i", c, a) * length_b
        )
        total += float(np.arctan2(numerator, denominator).sum())
    return total / (2 * np.pi)


def keep_largest(mesh: trimesh.Trimesh, pieces: Sequence[Piece], count: int) -> trimesh.Trimesh:
    """The `count` largest of `pieces`, with their colors."""
    faces = np.sort(np.concatenate([piece.faces for piece in pieces[:count]]))
    return mesh.submesh([faces], append=True, repair=False)


def pieces_sentence(pieces: Sequence[Piece], kept: int | None) -> str:
    """In how many pieces the mesh is, how much the largest is, and what was kept."""
    if len(pieces) == 1:
        return "in 1 piece"
    share = pieces[0].volume / sum(piece.volume for piece in pieces)
    text = f"in {len(pieces)} pieces, of which the largest has {share:.1%} of the volume"
    if kept is None:
        return f"{text} (--mesh-pieces 1 keeps that alone)"
    return f"{text}; the {min(kept, len(pieces))} largest are kept"
