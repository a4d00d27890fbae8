"""The edges of an indexed mesh, and connected components.

An edge is sound if exactly two faces share it and run along it oppositely.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


@dataclass(frozen=True)
class Edges:
    """Every edge once, low vertex first."""

    ends: Int[np.ndarray, "e 2"]
    face_count: Int[np.ndarray, "e"]  # faces that have it
    forward_count: Int[np.ndarray, "e"]  # of them those that run from low to high
    edges_of_face: Int[np.ndarray, "m 3"]  # side k of a face runs from its corner k to the next

    @property
    def is_sound(self) -> Bool[np.ndarray, "e"]:
        return (self.face_count == 2) & (self.forward_count == 1)

    def adjacent_faces(self) -> tuple[Int[np.ndarray, "p 2"], Bool[np.ndarray, "p"]]:
        """The two faces at every edge that has two, and whether they run along it oppositely."""
        side = np.argsort(self.edges_of_face.ravel(), kind="stable")
        double = self.face_count == 2
        first = (np.cumsum(self.face_count) - self.face_count)[double]
        faces = np.stack([side[first] // 3, side[first + 1] // 3], axis=1)
        return faces, self.forward_count[double] == 1


def build_edges(faces: Int[np.ndarray, "m 3"]) -> Edges:
    start, end = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel()
    n = int(faces.max(initial=0)) + 1
    keys, edge, count = np.unique(
        np.minimum(start, end) * n + np.maximum(start, end), return_inverse=True, return_counts=True
    )
    forward = np.bincount(edge, weights=start < end, minlength=len(keys)).astype(np.int64)
    ends = np.stack([keys // n, keys % n], axis=1)
    return Edges(ends, count, forward, edge.reshape(-1, 3))


def component_labels(pairs: Int[np.ndarray, "p 2"], n: int) -> Int[np.ndarray, "n"]:
    """For `n` things joined in `pairs`, the number of the component of each."""
    graph = coo_array((np.ones(len(pairs), np.int8), pairs.T), shape=(n, n))
    return connected_components(graph, directed=False)[1]
