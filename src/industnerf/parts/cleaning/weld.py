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
from industnerf.parts.cleaning.edges import components, edges_of
from industnerf.parts.cleaning.selection import compacted
from industnerf.schema import CleanParams

CROWD = 64  # neighbours per vertex; no surface has so many, and their pairs would fill the memory


def weld(solids: list[Mesh], settings: CleanParams) -> tuple[list[Mesh], list[str], list[str]]:
    """Each of `solids` by itself, so that solids that touch stay apart."""
    welded, bridged = zip(*(_welded(solid, settings.weld) for solid in solids), strict=True)
    gaps = f"gaps of at most {settings.weld:g} of the diagonal"
    told = f"vertices joined across {gaps}: {sum(bridged)}"
    return list(welded), [told] if sum(bridged) else [], []


def _welded(solid: Mesh, tolerance: float) -> tuple[Mesh, int]:
    """The mesh, and how many vertices lost a position of their own."""
    edges = edges_of(solid.faces)
    loose = np.unique(edges.ends[~edges.sound])
    if not len(loose):
        return solid, 0
    place = coincident(solid.vertices[loose])
    first = np.unique(place, return_index=True)[1]
    group = components(_near(solid.vertices[loose[first]], tolerance), len(first))
    merged = group[place]
    target = np.arange(len(solid.vertices))
    target[loose] = loose[np.unique(merged, return_index=True)[1]][merged]
    faces = target[solid.faces].astype(np.int32)
    return compacted(Mesh(solid.vertices, faces, solid.finish)), len(first) - len(np.unique(group))


def coincident(points: Float[np.ndarray, "n 3"]) -> Int[np.ndarray, "n"]:
    """A number for each of `points`, the same for those at exactly the same place."""
    order = np.lexsort(points.T)  # several times faster than np.unique by rows
    ordered = points[order]
    new = np.ones(len(points), bool)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    number = np.empty(len(points), np.int64)
    number[order] = np.cumsum(new) - 1
    return number


def _near(points: Float[np.ndarray, "n 3"], tolerance: float) -> Int[np.ndarray, "p 2"]:
    tree = cKDTree(points)
    crowd = tree.count_neighbors(tree, tolerance) / len(points) - 1
    if crowd > CROWD:
        raise BadPart(
            f"each vertex has {crowd:.0f} others within {tolerance:g} diagonals (parts.clean.weld) "
            "on average: one vertex lies so far off that the rest is a point beside it, or "
            "parts.clean.weld is too large"
        )
    return tree.query_pairs(tolerance, output_type="ndarray")
