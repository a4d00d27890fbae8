"""From a drawn shape to one closed, outward oriented surface mesh, in mm.

Each solid is meshed and welded by itself; solids that touch or overlap (a thread on its shank, a
ball in its race) are then united as meshes, so that no surface is left inside.
"""

from dataclasses import dataclass

import manifold3d
import numpy as np
from build123d import Shape, Solid
from jaxtyping import Float, Int, Int32
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.TopAbs import TopAbs_Orientation
from OCP.TopLoc import TopLoc_Location
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from industnerf.errors import BadPart
from industnerf.parts import checks
from industnerf.parts.recipe import MeshBoolean

# Shares of the part's bounding-box diagonal.  The chord error is 0.2 px of a 512 px view.
CHORD = 5e-4
WELD = 1e-6
SIMPLIFY = 5e-5

FILM = 1e-12  # share of the diagonal's cube

TURN = 0.25  # rad, the most that neighbouring facets of a curved face may turn


@dataclass(frozen=True)
class Mesh:
    vertices: Float[np.ndarray, "n 3"]
    faces: Int32[np.ndarray, "m 3"]
    brep_volume_mm3: float | None  # exact; None unless the part is one solid of OpenCASCADE's


def tessellate(shape: Shape | MeshBoolean) -> Mesh:
    """The closed surface of `shape`.

    Raises `BadPart` if a face cannot be meshed or the solids do not unite to a manifold.
    """
    join, cut = (shape.join, shape.cut) if isinstance(shape, MeshBoolean) else ([shape], [])
    solids = [solid for piece in join for solid in piece.solids()]
    if not solids:
        raise BadPart("the drawing holds no solid")
    boxes = [solid.bounding_box() for solid in solids]
    low = np.min([tuple(box.min) for box in boxes], axis=0)
    high = np.max([tuple(box.max) for box in boxes], axis=0)
    diagonal = float(np.linalg.norm(high - low))

    if len(solids) == 1 and not cut:
        vertices, faces = surface(solids[0], diagonal)
        return Mesh(vertices, faces, float(solids[0].volume))

    united = manifold3d.Manifold.batch_boolean(
        [manifold(solid, diagonal) for solid in solids], manifold3d.OpType.Add
    )
    for solid in (solid for piece in cut for solid in piece.solids()):
        united -= manifold(solid, diagonal)
    # Surfaces that coincide can leave a film behind: a closed piece that holds nothing.
    pieces = united.simplify(SIMPLIFY * diagonal).decompose()
    solid_pieces = [piece for piece in pieces if abs(piece.volume()) > FILM * diagonal**3]
    mesh = manifold3d.Manifold.compose(solid_pieces).to_mesh64()
    return Mesh(mesh.vert_properties[:, :3].copy(), mesh.tri_verts.astype(np.int32), None)


def surface(
    solid: Solid, diagonal: float
) -> tuple[Float[np.ndarray, "n 3"], Int32[np.ndarray, "m 3"]]:
    """The welded triangles of one solid; `diagonal` (mm) sets the tolerances."""
    BRepTools.Clean_s(solid.wrapped)  # a bounding box may have left a coarser triangulation
    BRepMesh_IncrementalMesh(solid.wrapped, CHORD * diagonal, False, TURN, False)
    points, corners, offset = [], [], 0
    for face in solid.faces():
        location = TopLoc_Location()
        # Not Shape.tessellate: it fails with "'NoneType' has no 'NbNodes'" on an unmeshed face.
        patch = BRep_Tool.Triangulation_s(face.wrapped, location)
        if patch is None:
            at = tuple(round(x, 2) for x in face.center())
            raise BadPart(f"OpenCASCADE left the face near {at} mm without triangles")
        move = location.Transformation()
        nodes = (patch.Node(i).Transformed(move) for i in range(1, patch.NbNodes() + 1))
        points += [(node.X(), node.Y(), node.Z()) for node in nodes]
        triangles = np.array([t.Get() for t in patch.Triangles()]) - 1 + offset
        if face.wrapped.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
            triangles = triangles[:, ::-1]
        corners.append(triangles)
        offset += patch.NbNodes()
    vertices, faces = weld(np.array(points), np.concatenate(corners), WELD * diagonal)
    if checks.volume_mm3(vertices, faces) < 0:  # some swept solids come inside out
        faces = np.ascontiguousarray(faces[:, ::-1])
    return vertices, faces


def weld(
    vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"], distance: float
) -> tuple[Float[np.ndarray, "welded 3"], Int32[np.ndarray, "kept 3"]]:
    """Merge vertices closer than `distance` (mm).

    Only faces with a repeated index go.  Slivers stay, however thin: each closes a gap.
    """
    i, j = cKDTree(vertices).query_pairs(distance, output_type="ndarray").T
    near = coo_array((np.ones(len(i)), (i, j)), shape=(len(vertices), len(vertices)))
    _, cluster = connected_components(near, directed=False)
    faces = cluster[faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(cluster, return_index=True)
    used, faces = np.unique(faces, return_inverse=True)
    return vertices[first[used]], faces.reshape(-1, 3).astype(np.int32)


def manifold(solid: Solid, diagonal: float) -> manifold3d.Manifold:
    vertices, faces = surface(solid, diagonal)
    mesh = manifold3d.Mesh64(vertices, np.ascontiguousarray(faces, dtype=np.uint64))
    body = manifold3d.Manifold(mesh)
    if body.status() != manifold3d.Error.NoError:
        at = tuple(round(x, 2) for x in solid.center())
        raise BadPart(f"the mesh of the solid near {at} mm is refused: {body.status().name}")
    return body
