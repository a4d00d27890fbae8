"""STEP, IGES and BREP through OpenCASCADE: every solid, shell or loose face of every instance.

Needs the [cad] extra.  The kernel turns the lengths of STEP and IGES into mm.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64
from OCP.BRep import BRep_Builder
from OCP.BRepTools import BRepTools
from OCP.collections import Sequence_TCollection_AsciiString, Sequence_TDF_Label
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.IGESCAFControl import IGESCAFControl_Reader
from OCP.Message import Message
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from industnerf.errors import BadPart
from industnerf.parts.reading.content import Body, Content, placed, short
from industnerf.parts.reading.kernel_mesh import box_of, meshed, pieces_of
from industnerf.parts.reading.kernel_paint import Paint, colour_of, name_of


def read_step(path: Path) -> Content:
    """Raises BadPart if the kernel finds no shape in the file."""
    reader = STEPCAFControl_Reader()
    document = _transferred(reader, path, "STEP")
    names = [Sequence_TCollection_AsciiString() for _ in range(3)]
    reader.ChangeReader().FileUnits(*names)
    units = dict.fromkeys(name.ToCString().lower() for name in names[0])
    return _content(document, " and ".join(map(short, units)) or "mm")


def read_iges(path: Path) -> Content:
    """Raises BadPart if the kernel finds no shape in the file."""
    reader = IGESCAFControl_Reader()
    document = _transferred(reader, path, "IGES")
    unit = reader.IGESModel().GlobalSection().UnitName()
    return _content(document, "mm" if unit is None else short(unit.ToCString()))


def read_brep(path: Path) -> Content:
    """The kernel's own format: one shape, no unit, no colour.  Raises BadPart if it is broken."""
    shape = TopoDS_Shape()
    if not BRepTools.Read_s(shape, str(path), BRep_Builder()) or shape.IsNull():
        raise BadPart("BREP: the kernel cannot read it")
    walk = _Walk()
    bodies = walk.leaf(shape, "solid", Paint.none())
    return Content(tuple(bodies), None, None, False, walk.remarks())


def _transferred(reader: Any, path: Path, what: str) -> TDocStd_Document:
    Message.DefaultMessenger_s().ChangePrinters().Clear()  # it prints to the terminal
    reader.SetColorMode(True)
    reader.SetNameMode(True)
    if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise BadPart(f"{what}: the kernel cannot parse it; it is broken or cut short")
    document = TDocStd_Document(TCollection_ExtendedString("industnerf"))
    if not reader.Transfer(document):
        raise BadPart(f"{what}: it parses, but holds no shape")
    return document


def _content(document: TDocStd_Document, unit: str) -> Content:
    roots = Sequence_TDF_Label()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(roots)
    walk = _Walk()
    bodies = [body for root in roots for body in walk.below(root, np.eye(4), None)]
    return Content(tuple(bodies), 1.0, unit, False, walk.remarks())


@dataclass
class _Walk:
    """A walk over the assembly; a part that is placed many times is meshed once."""

    made: dict[int, list[Body]] = field(default_factory=dict)
    bare: int = 0  # faces that the kernel could not mesh
    sheets: int = 0  # bodies that are no solids
    unboxed: int = 0  # bodies without extent, or without end

    def below(
        self, label: TDF_Label, matrix: np.ndarray, paint: np.ndarray | None
    ) -> Iterator[Body]:
        """The bodies of `label`, placed.  The innermost colour counts."""
        own = colour_of(label)
        paint = paint if own is None else own
        referred, parts = TDF_Label(), Sequence_TDF_Label()
        if XCAFDoc_ShapeTool.GetReferredShape_s(label, referred):
            moved = matrix @ _matrix(XCAFDoc_ShapeTool.GetLocation_s(label))
            yield from self.below(referred, moved, paint)
        elif XCAFDoc_ShapeTool.GetComponents_s(label, parts):
            for part in parts:
                yield from self.below(part, matrix, paint)
        else:
            if label.Tag() not in self.made:
                shape = XCAFDoc_ShapeTool.GetShape_s(label)
                self.made[label.Tag()] = self.leaf(shape, name_of(label), Paint.of(label))
            for body in self.made[label.Tag()]:
                yield placed(_painted(body, paint), matrix, body.name)

    def leaf(self, shape: TopoDS_Shape, name: str, paint: Paint) -> list[Body]:
        """The bodies of one shape, in its own frame."""
        found = []
        for piece, solid in pieces_of(shape):
            box = box_of(piece)
            if box is None:
                self.unboxed += 1
                continue
            mesh, bare = meshed(piece, box, paint)
            self.bare += bare
            self.sheets += not solid
            if mesh is not None:
                found.append(mesh)
        names = [name] if len(found) == 1 else [f"{name} {i + 1}" for i in range(len(found))]
        return [Body(n, *mesh) for n, mesh in zip(names, found, strict=True)]

    def remarks(self) -> tuple[str, ...]:
        """What the kernel left out, or found to be no solid."""
        said = []
        if self.bare:
            said.append(f"faces left out, for the kernel could not mesh them: {self.bare}")
        if self.unboxed:
            said.append(f"bodies left out, for they have no extent or no end: {self.unboxed}")
        if self.sheets:
            said.append(f"bodies that are shells or loose faces, not solids: {self.sheets}")
        return tuple(said)


def _painted(body: Body, paint: np.ndarray | None) -> Body:
    if paint is None:
        return body
    bare = np.isnan(body.albedo).any(axis=1, keepdims=True)
    return Body(body.name, body.vertices, body.faces, np.where(bare, paint, body.albedo))


def _matrix(location: TopLoc_Location) -> Float64[np.ndarray, "4 4"]:
    move, matrix = location.Transformation(), np.eye(4)
    matrix[:3] = [[move.Value(i, j) for j in range(1, 5)] for i in range(1, 4)]
    return matrix
