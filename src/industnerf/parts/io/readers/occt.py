"""STEP, IGES and BREP through OpenCASCADE: every solid, shell or loose face of every instance.

Needs the [cad] extra.  OpenCASCADE turns the lengths of STEP and IGES into mm.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepTools import BRepTools
from OCP.collections import Sequence_TCollection_AsciiString, Sequence_TDF_Label
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.IGESCAFControl import IGESCAFControl_Reader
from OCP.Message import Message
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound, TopoDS_Shape
from OCP.XCAFDoc import (
    XCAFDoc_ColorTool,
    XCAFDoc_ColorType,
    XCAFDoc_DocumentTool,
    XCAFDoc_ShapeTool,
)

from industnerf.errors import BadPart
from industnerf.parts.io.occt_triangulation import faces_of
from industnerf.parts.io.readers.mesh_content import (
    MeshBody,
    MeshContent,
    normalize_unit,
    transform_body,
)
from industnerf.parts.io.readers.occt_piece import triangulate_piece, wrong_areas_warning

UNNAMED = ("SOLID", "COMPOUND", "SHELL", "=>")  # what the kernel calls what has no name


@dataclass(frozen=True)
class ColorTable:
    """The colors within one part: of its faces, or of its solids."""

    albedos_of_face: dict[int, list[tuple[TopoDS_Shape, Float64[np.ndarray, "3"]]]]

    @staticmethod
    def empty() -> "ColorTable":
        """A part without colors."""
        return ColorTable({})

    @staticmethod
    def from_label(label: TDF_Label) -> "ColorTable":
        """The colors of the faces and solids of the part at `label`."""
        albedos_of_face: dict[int, list] = {}
        parts = Sequence_TDF_Label()
        XCAFDoc_ShapeTool.GetSubShapes_s(label, parts)
        shapes = [(XCAFDoc_ShapeTool.GetShape_s(part), albedo_of(part)) for part in parts]
        # Whole solids first, so that a face's own color, which comes later, goes before.
        for shape, color in sorted(shapes, key=lambda pair: _is_face(pair[0])):
            if color is not None:
                for face in faces_of(shape):
                    albedos_of_face.setdefault(hash(face), []).append((face, color))
        return ColorTable(albedos_of_face)

    def face_albedo(self, face: TopoDS_Shape) -> Float64[np.ndarray, "3"]:
        """The albedo of `face`; NaN if none is stated."""
        stated = [
            color for other, color in self.albedos_of_face.get(hash(face), []) if other.IsSame(face)
        ]
        return stated[-1] if stated else np.full(3, np.nan)


@dataclass
class _AssemblyWalker:
    """A walk over the assembly; a part that is placed many times is meshed once."""

    cache: dict[int, list[MeshBody]] = field(default_factory=dict)
    num_unmeshed: int = 0  # faces that the kernel could not mesh
    num_non_solids: int = 0  # bodies that are no solids
    num_unbounded: int = 0  # bodies without extent, or without end
    num_repaired: int = 0  # bodies with invalid faces, of which the kernel could repair some
    wrong_areas: list[str] = field(default_factory=list)  # of faces, see `PieceMesh`

    def iter_bodies(
        self, label: TDF_Label, matrix: np.ndarray, inherited: np.ndarray | None
    ) -> Iterator[MeshBody]:
        """The bodies of `label`, placed.  The innermost color counts."""
        own_albedo = albedo_of(label)
        inherited = inherited if own_albedo is None else own_albedo
        referred, parts = TDF_Label(), Sequence_TDF_Label()
        if XCAFDoc_ShapeTool.GetReferredShape_s(label, referred):
            placed_matrix = matrix @ _matrix(XCAFDoc_ShapeTool.GetLocation_s(label))
            yield from self.iter_bodies(referred, placed_matrix, inherited)
        elif XCAFDoc_ShapeTool.GetComponents_s(label, parts):
            for part in parts:
                yield from self.iter_bodies(part, matrix, inherited)
        else:
            if label.Tag() not in self.cache:
                shape = XCAFDoc_ShapeTool.GetShape_s(label)
                self.cache[label.Tag()] = self.shape_bodies(
                    shape, name_of(label), ColorTable.from_label(label)
                )
            for body in self.cache[label.Tag()]:
                yield transform_body(_with_color(body, inherited), matrix, body.name)

    def shape_bodies(
        self, shape: TopoDS_Shape, name: str, color_table: ColorTable
    ) -> list[MeshBody]:
        """The bodies of one shape, in its own frame."""
        meshes = []
        for piece, solid in split_shape(shape):
            box = bounding_box(piece)
            if box is None:
                self.num_unbounded += 1
                continue
            mesh = triangulate_piece(piece, box, color_table.face_albedo)
            self.num_unmeshed += mesh.num_unmeshed
            self.num_non_solids += not solid
            self.num_repaired += mesh.is_repaired
            self.wrong_areas += mesh.wrong_areas
            if len(mesh.faces):
                meshes.append((mesh.vertices, mesh.faces, mesh.albedo))
        names = [name] if len(meshes) == 1 else [f"{name} {i + 1}" for i in range(len(meshes))]
        return [MeshBody(n, *mesh) for n, mesh in zip(names, meshes, strict=True)]

    def warnings(self) -> tuple[str, ...]:
        """What the kernel left out, or found to be no solid."""
        messages = []
        if self.num_unmeshed:
            messages.append(
                f"faces left out, for the kernel could not mesh them: {self.num_unmeshed}"
            )
        if self.num_repaired:
            messages.append(
                f"bodies with invalid faces that the kernel repaired: {self.num_repaired}"
            )
        if self.wrong_areas:
            messages.append(wrong_areas_warning(self.wrong_areas))
        if self.num_unbounded:
            messages.append(
                f"bodies left out, for they have no extent or no end: {self.num_unbounded}"
            )
        if self.num_non_solids:
            messages.append(
                f"bodies that are shells or loose faces, not solids: {self.num_non_solids}"
            )
        return tuple(messages)


def read_step(path: Path) -> MeshContent:
    """Raises BadPart if the kernel finds no shape in the file."""
    reader = STEPCAFControl_Reader()
    document = _read_document(reader, path, "STEP")
    names = [Sequence_TCollection_AsciiString() for _ in range(3)]
    reader.ChangeReader().FileUnits(*names)
    units = dict.fromkeys(name.ToCString().lower() for name in names[0])
    return _read_content(document, " and ".join(map(normalize_unit, units)) or "mm")


def read_iges(path: Path) -> MeshContent:
    """Raises BadPart if the kernel finds no shape in the file."""
    reader = IGESCAFControl_Reader()
    document = _read_document(reader, path, "IGES")
    unit = reader.IGESModel().GlobalSection().UnitName()
    return _read_content(document, "mm" if unit is None else normalize_unit(unit.ToCString()))


def read_brep(path: Path) -> MeshContent:
    """The kernel's own format: one shape, no unit, no color.  Raises BadPart if it is broken."""
    shape = TopoDS_Shape()
    if not BRepTools.Read_s(shape, str(path), BRep_Builder()) or shape.IsNull():
        raise BadPart("BREP: the kernel cannot read it")
    walker = _AssemblyWalker()
    bodies = walker.shape_bodies(shape, "solid", ColorTable.empty())
    return MeshContent(tuple(bodies), None, None, False, walker.warnings())


def _read_document(reader: Any, path: Path, format_name: str) -> TDocStd_Document:
    Message.DefaultMessenger_s().ChangePrinters().Clear()  # it prints to the terminal
    reader.SetColorMode(True)
    reader.SetNameMode(True)
    if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise BadPart(f"{format_name}: the kernel cannot parse it; it is broken or cut short")
    document = TDocStd_Document(TCollection_ExtendedString("industnerf"))
    if not reader.Transfer(document):
        raise BadPart(f"{format_name}: it parses, but holds no shape")
    return document


def _read_content(document: TDocStd_Document, unit: str) -> MeshContent:
    roots = Sequence_TDF_Label()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(roots)
    walker = _AssemblyWalker()
    bodies = [body for root in roots for body in walker.iter_bodies(root, np.eye(4), None)]
    return MeshContent(tuple(bodies), 1.0, unit, False, walker.warnings(), is_in_mm=True)


def _with_color(body: MeshBody, albedo: np.ndarray | None) -> MeshBody:
    if albedo is None:
        return body
    is_unstated = np.isnan(body.albedo).any(axis=1, keepdims=True)
    return MeshBody(
        body.name, body.vertices, body.faces, np.where(is_unstated, albedo, body.albedo)
    )


def _matrix(location: TopLoc_Location) -> Float64[np.ndarray, "4 4"]:
    transform, matrix = location.Transformation(), np.eye(4)
    matrix[:3] = [[transform.Value(i, j) for j in range(1, 5)] for i in range(1, 4)]
    return matrix


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


def bounding_box(piece: TopoDS_Shape) -> Bnd_Box | None:
    """The box about `piece`; None if the piece has no extent, or no end."""
    box = Bnd_Box()
    BRepBndLib.Add_s(piece, box, False)
    return None if box.IsVoid() or box.IsOpen() else box


def albedo_of(label: TDF_Label) -> Float64[np.ndarray, "3"] | None:
    """The albedo at `label`; None if it states none."""
    color = Quantity_Color()  # linear inside: the kernel decodes the sRGB of the file
    for kind in (XCAFDoc_ColorType.XCAFDoc_ColorSurf, XCAFDoc_ColorType.XCAFDoc_ColorGen):
        if XCAFDoc_ColorTool.GetColor_s(label, kind, color):
            return np.array(color.Values(Quantity_TypeOfColor.Quantity_TOC_RGB))
    return None


def name_of(label: TDF_Label) -> str:
    """The name at `label`, or `solid`."""
    name = TDataStd_Name()
    # Asked first: to search for a name that is not there ends the process.
    if not label.IsAttribute(TDataStd_Name.GetID_s()):
        return "solid"
    label.FindAttribute(TDataStd_Name.GetID_s(), name)
    text = name.Get().ToExtString().strip()
    return "solid" if not text or text.startswith(UNNAMED) else text


def _is_face(shape: TopoDS_Shape) -> bool:
    return shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_FACE
