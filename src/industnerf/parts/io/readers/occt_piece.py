"""The triangles of one OpenCASCADE shape, and whether they have the area of its faces.

A boundary whose curves do not lie on their surface is invalid, yet the kernel meshes it without a
word, and a cone comes out for a cylinder's wall.  The kernel knows each face's area by itself, so
that both are compared.  Where they differ the shape is repaired or meshed finer; what differs
still is named.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64, Int64
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Tool
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.GProp import GProp_GProps
from OCP.ShapeFix import ShapeFix_Shape
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

from industnerf.parts.io.occt_triangulation import (
    ANGULAR_DEFLECTION,
    LINEAR_DEFLECTION,
    faces_of,
    triangulation_of,
)
from industnerf.parts.validation.checks import area_mm2

AREA_TOLERANCE = 0.05  # of the area of a face
MIN_AREA_SHARE = 1e-5  # of the area of the shape: a difference below it is no matter
FINER = 0.5  # of the usual deflections, for a last try
MAX_NAMED = 3  # of the faces whose area differs

FaceAlbedo = Callable[[TopoDS_Shape], Float64[np.ndarray, "3"]]  # NaN if none is stated


@dataclass(frozen=True)
class PieceMesh:
    """The triangles of a shape.  They are not welded: the repair does that."""

    vertices: Float64[np.ndarray, "n 3"]
    faces: Int64[np.ndarray, "m 3"]
    albedo: Float64[np.ndarray, "m 3"]
    num_unmeshed: int  # faces that the kernel left without triangles
    wrong_areas: tuple[str, ...]  # a phrase for each face whose triangles miss its area
    is_repaired: bool = False  # a later try than the first gave it


def triangulate_piece(piece: TopoDS_Shape, box: Bnd_Box, face_albedo: FaceAlbedo) -> PieceMesh:
    """The triangles of `piece` in its `box`; of several tries the one that misses least."""
    diagonal = box.CornerMin().Distance(box.CornerMax())
    best: PieceMesh | None = None
    for shape, original_of, factor in _tries(piece):
        BRepTools.Clean_s(shape)  # a bounding box may have left a coarser triangulation
        BRepMesh_IncrementalMesh(
            shape, factor * LINEAR_DEFLECTION * diagonal, False, factor * ANGULAR_DEFLECTION, False
        )
        mesh = _collect(shape, lambda face, originals=original_of: face_albedo(originals(face)))
        if best is None:
            best = mesh
        elif _num_faulty(mesh) < _num_faulty(best):
            best = replace(mesh, is_repaired=True)
        if not _num_faulty(best):
            break
    return best


def _tries(
    piece: TopoDS_Shape,
) -> Iterator[tuple[TopoDS_Shape, Callable[[TopoDS_Face], TopoDS_Shape], float]]:
    """A shape to mesh, the face of `piece` that each of its faces was, and a factor of fineness."""
    yield piece, lambda face: face, 1.0
    fixer = ShapeFix_Shape(piece)
    fixer.Perform()
    originals = {hash(fixer.Context().Apply(face)): face for face in faces_of(piece)}

    def original_of(face: TopoDS_Face) -> TopoDS_Shape:
        return originals.get(hash(face), face)

    yield fixer.Shape(), original_of, 1.0
    yield fixer.Shape(), original_of, FINER


def _num_faulty(mesh: PieceMesh) -> int:
    return mesh.num_unmeshed + len(mesh.wrong_areas)


def _collect(shape: TopoDS_Shape, face_albedo: FaceAlbedo) -> PieceMesh:
    points, corners, albedo = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], [np.empty((0, 3))]
    areas, offset, num_unmeshed = [], 0, 0
    for number, face in enumerate(faces_of(shape), start=1):
        triangles = triangulation_of(face)
        if triangles is None:
            num_unmeshed += 1
            continue
        points.append(triangles[0])
        corners.append(triangles[1] + offset)
        albedo.append(np.broadcast_to(face_albedo(face), (len(triangles[1]), 3)))
        meshed = area_mm2(*triangles)
        exact = (
            meshed if BRep_Tool.Surface_s(face) is None else _kernel_area(face)
        )  # triangles alone
        areas.append((number, meshed, exact, triangles[0].mean(axis=0)))
        offset += len(triangles[0])
    total = sum(exact for _, _, exact, _ in areas)
    return PieceMesh(
        np.concatenate(points),
        np.concatenate(corners).astype(np.int64),
        np.concatenate(albedo),
        num_unmeshed,
        tuple(
            f"face {number} near ({center[0]:.4g}, {center[1]:.4g}, {center[2]:.4g}) mm has "
            f"{meshed:.4g} of {exact:.4g} mm\u00b2"
            for number, meshed, exact, center in areas
            if abs(meshed - exact) > max(AREA_TOLERANCE * exact, MIN_AREA_SHARE * total)
        ),
    )


def _kernel_area(face: TopoDS_Face) -> float:
    """The area (mm^2) of `face` as the kernel integrates it over the surface."""
    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, properties)
    return abs(properties.Mass())


def wrong_areas_warning(wrong_areas: list[str]) -> str:
    """A sentence on the faces whose triangles miss their area."""
    more = len(wrong_areas) - MAX_NAMED
    named = "; ".join(wrong_areas[:MAX_NAMED]) + (f"; and {more} more" if more > 0 else "")
    return (
        f"faces whose triangles miss the area that the drawing gives them by more than "
        f"{AREA_TOLERANCE:.0%}, so the drawing is invalid there: {len(wrong_areas)} ({named})"
    )
