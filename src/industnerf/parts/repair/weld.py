"""Vertices that should be one, made one.

A file that stores every triangle by itself (STL), or cracks a surface where its normals jump, has
borders within its surface.  So only vertices on unsound edges are welded: a solid that is stored
closed stays as it is, though the crests of its threads may come closer than any safe tolerance.
"""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.parts.repair.edges import build_edges, component_labels
from industnerf.parts.repair.mesh_ops import drop_unused_vertices
from industnerf.schema import RepairParams

MAX_NEIGHBORS = (
    64  # neighbors per vertex; no surface has so many, and their pairs would fill the memory
)


def weld(solids: list[Mesh], settings: RepairParams) -> tuple[list[Mesh], list[str], list[str]]:
    """Each of `solids` by itself, so that solids that touch stay apart."""
    welded, num_merged = zip(*(_weld_solid(solid, settings.weld) for solid in solids), strict=True)
    gaps = f"gaps of at most {settings.weld:g} of the diagonal"
    message = f"vertices joined across {gaps}: {sum(num_merged)}"
    return list(welded), [message] if sum(num_merged) else [], []


def _weld_solid(solid: Mesh, tolerance: float) -> tuple[Mesh, int]:
    """The mesh, and how many vertices lost a position of their own."""
    edges = build_edges(solid.faces)
    unsound_vertices = np.unique(edges.ends[~edges.is_sound])
    if not len(unsound_vertices):
        return solid, 0
    position = coincident_groups(solid.vertices[unsound_vertices])
    first = np.unique(position, return_index=True)[1]
    group = component_labels(
        _close_pairs(solid.vertices[unsound_vertices[first]], tolerance), len(first)
    )
    merged = group[position]
    target = np.arange(len(solid.vertices))
    target[unsound_vertices] = unsound_vertices[np.unique(merged, return_index=True)[1]][merged]
    faces = target[solid.faces].astype(np.int32)
    return drop_unused_vertices(Mesh(solid.vertices, faces, solid.finish)), len(first) - len(
        np.unique(group)
    )


def coincident_groups(points: Float[np.ndarray, "n 3"]) -> Int[np.ndarray, "n"]:
    """A number for each of `points`, the same for those at exactly the same place."""
    order = np.lexsort(points.T)  # several times faster than np.unique by rows
    ordered = points[order]
    is_new = np.ones(len(points), bool)
    is_new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    number = np.empty(len(points), np.int64)
    number[order] = np.cumsum(is_new) - 1
    return number


def _close_pairs(points: Float[np.ndarray, "n 3"], tolerance: float) -> Int[np.ndarray, "p 2"]:
    tree = cKDTree(points)
    mean_neighbors = tree.count_neighbors(tree, tolerance) / len(points) - 1
    if mean_neighbors > MAX_NEIGHBORS:
        raise BadPart(
            f"each vertex has {mean_neighbors:.0f} others within {tolerance:g} diagonals "
            "(parts.repair.weld) on average: one vertex lies so far off that the rest is a point "
            "beside it, or parts.repair.weld is too large"
        )
    return tree.query_pairs(tolerance, output_type="ndarray")
