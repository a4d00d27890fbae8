"""The surface of an OpenCASCADE shape as welded triangles."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, Int, Int32
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Shape
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from industnerf.errors import BadPart
from industnerf.parts.validation import checks

WELD_TOLERANCE = 1e-6  # share of the diagonal
LINEAR_DEFLECTION = (
    5e-4  # share of the diagonal, the most that a facet may stand off: 0.2 px of a 512 px view
)
ANGULAR_DEFLECTION = 0.25  # rad, the most that neighboring facets of a curved face may turn


def triangulate_shape(
    shape: TopoDS_Shape, linear_deflection_mm: float, angular_deflection: float, diagonal_mm: float
) -> tuple[Float[np.ndarray, "n 3"], Int32[np.ndarray, "m 3"]]:
    """The welded triangles of one solid, outward oriented.

    `linear_deflection_mm` and `angular_deflection` (rad) bound the deviation of the facets,
    `diagonal_mm` sets the distance within which vertices merge.
    Raises `BadPart` if a face cannot be meshed.
    """
    BRepTools.Clean_s(shape)  # a bounding box may have left a coarser triangulation
    BRepMesh_IncrementalMesh(shape, linear_deflection_mm, False, angular_deflection, False)
    points, corners, offset = [], [], 0
    for face in faces_of(shape):
        triangles = triangulation_of(face)
        if triangles is None:
            raise BadPart("OpenCASCADE left a face without triangles")
        points.append(triangles[0])
        corners.append(triangles[1] + offset)
        offset += len(triangles[0])
    vertices, faces = merge_vertices(
        np.concatenate(points), np.concatenate(corners), WELD_TOLERANCE * diagonal_mm
    )
    if checks.volume_mm3(vertices, faces) < 0:  # some swept solids come inside out
        faces = np.ascontiguousarray(faces[:, ::-1])
    return vertices, faces


def faces_of(shape: TopoDS_Shape) -> Iterator[TopoDS_Face]:
    explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE)
    while explorer.More():
        yield TopoDS.Face(explorer.Current())
        explorer.Next()


def triangulation_of(
    face: TopoDS_Face,
) -> tuple[Float[np.ndarray, "n 3"], Int[np.ndarray, "m 3"]] | None:
    """The triangles of one meshed face, oriented as it is; None if OpenCASCADE left it bare."""
    location = TopLoc_Location()
    # Not Shape.tessellate: it fails with "'NoneType' has no 'NbNodes'" on an unmeshed face.
    triangulation = BRep_Tool.Triangulation_s(face, location)
    if triangulation is None:
        return None
    transform = location.Transformation()
    nodes = (
        triangulation.Node(i).Transformed(transform) for i in range(1, triangulation.NbNodes() + 1)
    )
    points = np.array([(node.X(), node.Y(), node.Z()) for node in nodes])
    corners = np.array([t.Get() for t in triangulation.Triangles()]) - 1
    reversed_ = face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
    return points, corners[:, ::-1] if reversed_ else corners


def merge_vertices(
    vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"], distance: float
) -> tuple[Float[np.ndarray, "welded 3"], Int32[np.ndarray, "kept 3"]]:
    """Merge vertices closer than `distance` (mm).

    Only faces with a repeated index go.  Slivers stay, however thin: each closes a gap.
    """
    i, j = cKDTree(vertices).query_pairs(distance, output_type="ndarray").T
    adjacency = coo_array((np.ones(len(i)), (i, j)), shape=(len(vertices), len(vertices)))
    _, cluster = connected_components(adjacency, directed=False)
    faces = cluster[faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(cluster, return_index=True)
    used, faces = np.unique(faces, return_inverse=True)
    return vertices[first[used]], faces.reshape(-1, 3).astype(np.int32)
