"""Pieces of a shape to triangles, as fine as the size of each piece asks."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float64, Int64
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Compound, TopoDS_Shape

from industnerf.parts.io.occt_triangulation import (
    ANGULAR_DEFLECTION,
    LINEAR_DEFLECTION,
    faces_of,
    triangulation_of,
)
from industnerf.parts.io.readers.occt_colors import ColorTable

MeshArrays = tuple[
    Float64[np.ndarray, "n 3"], Int64[np.ndarray, "m 3"], Float64[np.ndarray, "m 3"]
]  # vertices, faces, albedo


def split_shape(shape: TopoDS_Shape) -> Iterator[tuple[TopoDS_Shape, bool]]:
    """Solids; shells in no solid; and all faces in no shell as one; with whether it is a solid."""
    solid, shell = TopAbs_ShapeEnum.TopAbs_SOLID, TopAbs_ShapeEnum.TopAbs_SHELL
    yield from ((piece, True) for piece in _explore(TopExp_Explorer(shape, solid)))
    yield from ((piece, False) for piece in _explore(TopExp_Explorer(shape, shell, solid)))
    loose_faces = list(_explore(TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE, shell)))
    if loose_faces:
        builder, compound = BRep_Builder(), TopoDS_Compound()
        builder.MakeCompound(compound)
        for face in loose_faces:
            builder.Add(compound, face)
        yield compound, False


def _explore(explorer: TopExp_Explorer) -> Iterator[TopoDS_Shape]:
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def triangulate_piece(
    piece: TopoDS_Shape, box: Bnd_Box, color_table: ColorTable
) -> tuple[MeshArrays | None, int]:
    """The triangles of `piece` in its `box`, and how many of its faces the kernel left bare.

    They are not welded: cleaning does that to what comes out of any reader.
    """
    diagonal = box.CornerMin().Distance(box.CornerMax())
    BRepMesh_IncrementalMesh(piece, LINEAR_DEFLECTION * diagonal, False, ANGULAR_DEFLECTION, False)
    points, corners, albedo, offset, num_unmeshed = [], [], [], 0, 0
    for face in faces_of(piece):
        triangulation = triangulation_of(face)
        if triangulation is None:
            num_unmeshed += 1
            continue
        points.append(triangulation[0])
        corners.append(triangulation[1] + offset)
        albedo.append(np.broadcast_to(color_table.face_albedo(face), (len(triangulation[1]), 3)))
        offset += len(triangulation[0])
    if not points:
        return None, num_unmeshed
    faces = np.concatenate(corners).astype(np.int64)
    return (np.concatenate(points), faces, np.concatenate(albedo)), num_unmeshed


def bounding_box(piece: TopoDS_Shape) -> Bnd_Box | None:
    """The box about `piece`; None if the piece has no extent, or no end."""
    box = Bnd_Box()
    BRepBndLib.Add_s(piece, box, False)
    return None if box.IsVoid() or box.IsOpen() else box
