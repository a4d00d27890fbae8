"""STEP of a drawing, exact, or of a mesh, as flat facets.  Needs the `[cad]` extra.

Lengths are in mm.  OpenCASCADE takes linear colors and writes them in sRGB, as STEP has them.
"""

from pathlib import Path

import numpy as np
from build123d import Color, Compound, Shape, export_step
from jaxtyping import Int32
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeShapeOnMesh
from OCP.gp import gp_Pnt
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Interface import Interface_Static
from OCP.Message import Message, Message_Gravity
from OCP.Poly import Poly_Triangle, Poly_Triangulation
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_StepModelType
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopoDS import TopoDS_Face, TopoDS_Shell, TopoDS_Solid
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.errors import BadPart
from industnerf.parts.catalogue.appearances import APPEARANCES
from industnerf.parts.catalogue.recipe import Assembly
from industnerf.parts.io.occt_triangulation import faces_of
from industnerf.parts.io.writers.mesh_formats import group_shells_by_solid
from industnerf.parts.validation import checks

MAX_FACETS = 50_000  # about 65 MB: what a CAD program still opens
MIN_FACET_HEIGHT_MM = 1e-7  # mm; OpenCASCADE leaves out a facet that is no higher
SURFACE_COLOR = XCAFDoc_ColorType.XCAFDoc_ColorSurf


def write_drawing(path: Path, drawing: Assembly) -> None:
    """The solids of a drawing without mesh booleans, each of the name and color of its finish.

    They overlap where the drawing has them overlap, as a thread and its shank do.  An only solid
    has the name of the part.
    """
    solids = [
        _label_solid(solid, APPEARANCES[name])
        for name, body in drawing.bodies.items()
        for solid in body.solids()
    ]
    whole = Compound(label=path.stem, children=solids) if len(solids) > 1 else solids[0]
    whole.label = path.stem
    export_step(whole, path)


def _label_solid(solid: Shape, finish: Appearance) -> Shape:
    solid.label, solid.color = finish.name, Color(*finish.albedo)
    return solid


def write_faceted(path: Path, mesh: Mesh, finishes: tuple[Appearance, ...]) -> None:
    """Every triangle as a plane face; raises BadPart above `MAX_FACETS` of them."""
    if len(mesh.faces) > MAX_FACETS:
        raise BadPart(
            f"{path.stem}: {len(mesh.faces)} facets, and a STEP file of more than {MAX_FACETS} "
            "is of no use to a CAD program. There is no exact drawing of this part; --format glb, "
            "ply, obj and stl have its mesh."
        )
    write_facets(path, mesh, finishes)


def write_facets(path: Path, mesh: Mesh, finishes: tuple[Appearance, ...]) -> None:
    """Write `mesh`, a solid a body; raises BadPart if OpenCASCADE refuses a facet."""
    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    XCAFApp_Application.GetApplication_s().NewDocument(
        TCollection_ExtendedString("MDTV-XCAF"), document
    )
    for shells in group_shells_by_solid(mesh):
        _add_solid(document, path.stem, mesh, shells, finishes)
    _write(path, document)


def _add_solid(
    document: TDocStd_Document,
    name: str,
    mesh: Mesh,
    shells: list[Int32[np.ndarray, "k"]],
    finishes: tuple[Appearance, ...],
) -> None:
    """One solid of an outer shell and any voids; it has the color of most of its facets."""
    colors = [
        Quantity_Color(*(finish.albedo or (1.0, 1.0, 1.0)), Quantity_TypeOfColor.Quantity_TOC_RGB)
        for finish in finishes
    ]
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    color_tool = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    builder, solid, facets = BRep_Builder(), TopoDS_Solid(), []
    builder.MakeSolid(solid)
    for shell in shells:
        faces, face_indices = _facets(mesh, shell)
        builder.Add(solid, _shell(builder, faces))
        facets += zip(faces, mesh.finish[face_indices].tolist(), strict=True)
    label = shapes.AddShape(solid, False)
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    main_finish = int(np.bincount([finish for _, finish in facets]).argmax())
    color_tool.SetColor(label, colors[main_finish], SURFACE_COLOR)
    for face, finish in facets:
        if finish != main_finish:
            color_tool.SetColor(shapes.AddSubShape(label, face), colors[finish], SURFACE_COLOR)


def _shell(builder: BRep_Builder, faces: list[TopoDS_Face]) -> TopoDS_Shell:
    shell = TopoDS_Shell()
    builder.MakeShell(shell)
    for face in faces:
        builder.Add(shell, face)
    shell.Closed(True)
    return shell


def _facets(
    mesh: Mesh, selected: Int32[np.ndarray, "k"]
) -> tuple[list[TopoDS_Face], Int32[np.ndarray, "j"]]:
    """Plane faces that share edges and corners, and which faces of the mesh they are."""
    triangles = mesh.triangles[selected]
    longest = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
    double_areas = np.linalg.norm(
        checks.double_area_normals(mesh.vertices, mesh.faces[selected]), axis=1
    )
    face_indices = selected[double_areas > MIN_FACET_HEIGHT_MM * longest]
    used, corners = np.unique(mesh.faces[face_indices], return_inverse=True)
    surface = Poly_Triangulation(len(used), len(face_indices), False)
    for i, position in enumerate(mesh.vertices[used].tolist(), 1):
        surface.SetNode(i, gp_Pnt(*position))
    for i, triangle in enumerate((corners.reshape(-1, 3) + 1).tolist(), 1):
        surface.SetTriangle(i, Poly_Triangle(*triangle))
    maker = BRepBuilderAPI_MakeShapeOnMesh(surface)
    maker.Build()
    faces = list(faces_of(maker.Shape()))
    if len(faces) != len(face_indices):
        raise BadPart(
            f"OpenCASCADE refuses {len(face_indices) - len(faces)} of {len(face_indices)} facets"
        )
    return faces, face_indices


def _write(path: Path, document: TDocStd_Document) -> None:
    for printer in Message.DefaultMessenger_s().Printers():
        printer.SetTraceLevel(Message_Gravity.Message_Fail)  # it says every step on the console
    writer = STEPCAFControl_Writer()
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)  # planes need no curves of their own
    writer.Transfer(document, STEPControl_StepModelType.STEPControl_AsIs)
    if writer.Write(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise BadPart(f"OpenCASCADE could not write {path}")
