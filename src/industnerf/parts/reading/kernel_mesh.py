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

from industnerf.parts.brep import CHORD, TURN, faces_of, triangles_of
from industnerf.parts.reading.kernel_paint import Paint

Mesh = tuple[
    Float64[np.ndarray, "n 3"], Int64[np.ndarray, "m 3"], Float64[np.ndarray, "m 3"]
]  # vertices, faces, albedo


def pieces_of(shape: TopoDS_Shape) -> Iterator[tuple[TopoDS_Shape, bool]]:
    """Solids; shells in no solid; and all faces in no shell as one; with whether it is a solid."""
    solid, shell = TopAbs_ShapeEnum.TopAbs_SOLID, TopAbs_ShapeEnum.TopAbs_SHELL
    yield from ((piece, True) for piece in _found(TopExp_Explorer(shape, solid)))
    yield from ((piece, False) for piece in _found(TopExp_Explorer(shape, shell, solid)))
    loose = list(_found(TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE, shell)))
    if loose:
        builder, together = BRep_Builder(), TopoDS_Compound()
        builder.MakeCompound(together)
        for face in loose:
            builder.Add(together, face)
        yield together, False


def _found(explorer: TopExp_Explorer) -> Iterator[TopoDS_Shape]:
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def meshed(piece: TopoDS_Shape, box: Bnd_Box, paint: Paint) -> tuple[Mesh | None, int]:
    """The triangles of `piece` in its `box`, and how many of its faces the kernel left bare.

    They are not welded: cleaning does that to what comes out of any reader.
    """
    diagonal = box.CornerMin().Distance(box.CornerMax())
    BRepMesh_IncrementalMesh(piece, CHORD * diagonal, False, TURN, False)
    points, corners, albedo, offset, bare = [], [], [], 0, 0
    for face in faces_of(piece):
        patch = triangles_of(face)
        if patch is None:
            bare += 1
            continue
        points.append(patch[0])
        corners.append(patch[1] + offset)
        albedo.append(np.broadcast_to(paint.on(face), (len(patch[1]), 3)))
        offset += len(patch[0])
    if not points:
        return None, bare
    faces = np.concatenate(corners).astype(np.int64)
    return (np.concatenate(points), faces, np.concatenate(albedo)), bare


def box_of(piece: TopoDS_Shape) -> Bnd_Box | None:
    """The box about `piece`; None if the piece has no extent, or no end."""
    box = Bnd_Box()
    BRepBndLib.Add_s(piece, box, False)
    return None if box.IsVoid() or box.IsOpen() else box
