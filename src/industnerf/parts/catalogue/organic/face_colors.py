"""Colors on a body: its triangles are cut along contours, so that every face has one color."""

from collections.abc import Callable, Sequence

import numpy as np
from jaxtyping import Bool, Float, Int
from manifold3d import Manifold

from industnerf.artifacts.part import Mesh
from industnerf.parts.catalogue.organic.forms import Field, Points, union

MIN_EDGE_SHARE = (
    0.1  # a contour that crosses an edge this near to its end, as a share, goes through the end
)
MIN_PIECE_MM3 = 1e-3  # of a piece

Color = Callable[[Points], Int[np.ndarray, "n"]]
"""Which finish the surface has at each point."""


def assemble(bodies: Sequence[Manifold], carved: Sequence[Manifold] = ()) -> Mesh:
    """Bodies united, then carved; each face has the number of the body or chisel that made it.

    Pieces without volume, left where surfaces coincide, and closed pores go.
    """
    originals = [body.as_original() for body in [*bodies, *carved]]
    whole = union(originals[: len(bodies)])
    if carved:
        whole -= union(originals[len(bodies) :])
    pieces = [piece for piece in whole.decompose() if piece.volume() > MIN_PIECE_MM3]
    mesh = Manifold.compose(pieces).to_mesh64()
    number = {original.original_id(): i for i, original in enumerate(originals)}
    lengths = np.diff(np.asarray(mesh.run_index, np.int64)) // 3
    finish = np.repeat([number[i] for i in mesh.run_original_id], lengths)
    vertices = np.ascontiguousarray(mesh.vert_properties[:, :3])
    return Mesh(vertices, mesh.tri_verts.astype(np.int32), finish.astype(np.uint8))


def color_faces(mesh: Mesh, contours: Sequence[Field], color: Color, finish_index: int = 0) -> Mesh:
    """`mesh` cut where a contour is zero, its faces of `finish_index` colored by their centers."""
    for contour in contours:
        mesh = cut_along_contour(mesh, contour, finish_index)
    finish = np.where(mesh.finish == finish_index, color(mesh.triangles.mean(axis=1)), mesh.finish)
    return Mesh(mesh.vertices, mesh.faces, finish.astype(np.uint8))


def cut_along_contour(mesh: Mesh, contour: Field, finish_index: int) -> Mesh:
    """`mesh` with an edge wherever `contour` passes through zero on faces of finish `finish_index`.

    A new vertex divides its edge for both faces, so a closed surface stays closed.
    """
    faces = mesh.faces.astype(np.int64)
    edges, edge = _edges(faces)
    value = _snap_to_ends(contour(mesh.vertices), edges)
    low, high = value[edges].T
    crossed = (low * high < 0) & _edges_of_faces(edge, mesh.finish == finish_index, len(edges))
    share = (low / np.where(crossed, low - high, 1))[crossed, None]
    start, end = mesh.vertices[edges[crossed]].transpose(1, 0, 2)
    vertices = np.concatenate([mesh.vertices, start + share * (end - start)])
    middle = np.full(len(edges), -1)
    middle[crossed] = len(mesh.vertices) + np.arange(crossed.sum())
    divided, parent = _split_faces(faces, middle[edge])
    return Mesh(vertices, divided.astype(np.int32), mesh.finish[parent])


def _edges(faces: Int[np.ndarray, "m 3"]) -> tuple[Int[np.ndarray, "e 2"], Int[np.ndarray, "m 3"]]:
    """Every edge once, and for each face the edges that follow its corners."""
    both = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1)
    n = int(faces.max()) + 1
    keys, edge = np.unique(both.min(axis=-1) * n + both.max(axis=-1), return_inverse=True)
    return np.stack([keys // n, keys % n], axis=1), edge.reshape(faces.shape)


def _snap_to_ends(
    value: Float[np.ndarray, "n"], edges: Int[np.ndarray, "e 2"]
) -> Float[np.ndarray, "n"]:
    """`value` with zeros where it crosses an edge so near to its end that a sliver would result."""
    low, high = value[edges].T
    crosses = low * high < 0
    share = low / np.where(crosses, low - high, 1)
    value = value.copy()
    value[edges[crosses & (share < MIN_EDGE_SHARE), 0]] = 0.0
    value[edges[crosses & (share > 1 - MIN_EDGE_SHARE), 1]] = 0.0
    return value


def _edges_of_faces(
    edge: Int[np.ndarray, "m 3"], mask: Bool[np.ndarray, "m"], count: int
) -> Bool[np.ndarray, "e"]:
    """Which edges are of a chosen face."""
    touched = np.zeros(count, bool)
    touched[edge[mask]] = True
    return touched


def _split_faces(
    faces: Int[np.ndarray, "m 3"], middle: Int[np.ndarray, "m 3"]
) -> tuple[Int[np.ndarray, "k 3"], Int[np.ndarray, "k"]]:
    """Faces divided at the new vertices on their edges (-1: none), and the face that each was."""
    split = middle >= 0
    count = split.sum(axis=1)  # never 3: of three signs two are equal
    # Turned so that of one divided edge it is the first, of two the second is the whole one.
    first = np.where(count == 2, ((~split).argmax(axis=1) + 2) % 3, split.argmax(axis=1))
    turn = (first[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(faces, turn, axis=1).T
    ab, _, ca = np.take_along_axis(middle, turn, axis=1).T
    whole, one, two = (np.flatnonzero(count == k) for k in range(3))
    pieces = [
        (whole, faces[whole]),
        (one, np.stack([a, ab, c], axis=1)[one]),
        (one, np.stack([ab, b, c], axis=1)[one]),
        (two, np.stack([a, ab, ca], axis=1)[two]),
        (two, np.stack([ab, b, c], axis=1)[two]),
        (two, np.stack([ab, c, ca], axis=1)[two]),
    ]
    return np.concatenate([f for _, f in pieces]), np.concatenate([p for p, _ in pieces])
