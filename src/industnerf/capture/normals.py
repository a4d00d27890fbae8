"""Normals for shading: smooth over a curved surface, sharp at its creases."""

import numpy as np
from jaxtyping import Float, Float32, Int, Int32
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

Faces = Int32[np.ndarray, "m 3"]


def face_normals(triangles: Float[np.ndarray, "m 3 3"]) -> Float[np.ndarray, "m 3"]:
    """Unit normals, counter-clockwise from outside; zero for a face without area."""
    a, b, c = triangles.transpose(1, 0, 2)
    return _unit(np.cross(b - a, c - a))


def corner_normals(
    vertices: Float[np.ndarray, "n 3"], faces: Faces, crease_deg: float
) -> Float32[np.ndarray, "m 3 3"]:
    """Unit normal at each corner of each face.

    It is the mean over the faces of the vertex that can be reached from the corner's own without
    crossing an edge sharper than `crease_deg`, weighted by area and angle: the area keeps a
    plane flat where a fillet begins, the angle makes the split of a quad into triangles not
    matter (Max, "Weights for Computing Vertex Normals from Facet Normals", 1999, compares).
    """
    triangles = vertices[faces]
    normals = face_normals(triangles)
    group = _smooth_groups(faces, normals, crease_deg)
    weighted = (_corner_weights(triangles)[:, :, None] * normals[:, None, :]).reshape(-1, 3)
    sums = np.stack([np.bincount(group, weighted[:, axis]) for axis in range(3)], axis=1)
    return _unit(sums)[group].reshape(-1, 3, 3).astype(np.float32)


def _smooth_groups(
    faces: Faces, normals: Float[np.ndarray, "m 3"], crease_deg: float
) -> Int[np.ndarray, "corners"]:
    """For each corner (3 * face + position) the number of the group that it is averaged with."""
    half_edge, twin = _edge_neighbors(faces)
    cosine = np.einsum("ij,ij->i", normals[half_edge // 3], normals[twin // 3])
    is_smooth = cosine > np.cos(np.radians(crease_deg))
    half_edge, twin = half_edge[is_smooth], twin[is_smooth]
    # Two faces share both ends of their edge: half-edge c runs from corner c to the next.
    links = [
        (half_edge, twin),
        (half_edge, _next(twin)),
        (_next(half_edge), twin),
        (_next(half_edge), _next(twin)),
    ]
    a, b = (np.concatenate(side) for side in zip(*links, strict=True))
    is_same_vertex = faces.ravel()[a] == faces.ravel()[b]
    graph = coo_array(
        (np.ones(is_same_vertex.sum(), bool), (a[is_same_vertex], b[is_same_vertex])),
        (faces.size, faces.size),
    )
    return connected_components(graph, directed=False)[1]


def _edge_neighbors(faces: Faces) -> tuple[Int[np.ndarray, "pairs"], Int[np.ndarray, "pairs"]]:
    """All pairs of half-edges that lie on one edge: of two faces, or of more."""
    start, end = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel()
    edge = np.minimum(start, end) * (int(faces.max()) + 1) + np.maximum(start, end)
    order = np.argsort(edge, kind="stable")
    edge, pairs = edge[order], []
    first = np.arange(len(edge))
    for step in range(1, len(edge)):  # ends after as many steps as the busiest edge has faces
        first = first[first + step < len(edge)]
        first = first[edge[first] == edge[first + step]]
        if not len(first):
            break
        pairs.append((order[first], order[first + step]))
    half_edge, twin = zip(*pairs, strict=True) if pairs else ([order[:0]], [order[:0]])
    return np.concatenate(half_edge), np.concatenate(twin)


def _next(corner: Int[np.ndarray, "n"]) -> Int[np.ndarray, "n"]:
    return corner + 1 - 3 * (corner % 3 == 2)


def _corner_weights(triangles: Float[np.ndarray, "m 3 3"]) -> Float[np.ndarray, "m 3"]:
    """Area times angle at each corner."""
    to_next = _unit(np.roll(triangles, -1, axis=1) - triangles)
    to_previous = _unit(np.roll(triangles, 1, axis=1) - triangles)
    angle = np.arccos(np.clip(np.einsum("mij,mij->mi", to_next, to_previous), -1, 1))
    a, b, c = triangles.transpose(1, 0, 2)
    return angle * np.linalg.norm(np.cross(b - a, c - a), axis=1)[:, None]


def _unit(vectors: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any 3"]:
    """`vectors` at length 1; zero stays zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0, length, 1)
