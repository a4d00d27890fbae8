"""STEP, IGES and BREP files drawn and written with the CAD kernel itself."""

from pathlib import Path

from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Transform
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeHalfSpace,
    BRepPrimAPI_MakeSphere,
)
from OCP.BRepTools import BRepTools
from OCP.gp import gp_Ax1, gp_Dir, gp_Pln, gp_Pnt, gp_Trsf, gp_Vec
from OCP.IGESCAFControl import IGESCAFControl_Writer
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_StepModelType
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound, TopoDS_Solid
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

from industnerf.parts.brep import faces_of

SURFACE = XCAFDoc_ColorType.XCAFDoc_ColorSurf


def box(x=30.0, y=20.0, z=10.0):
    return BRepPrimAPI_MakeBox(x, y, z).Shape()


def half_space():
    """A solid without end: everything below z = 0."""
    plane = BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Face()
    return BRepPrimAPI_MakeHalfSpace(plane, gp_Pnt(0, 0, -1)).Solid()


def nothing():
    """A solid without a shell."""
    solid = TopoDS_Solid()
    BRep_Builder().MakeSolid(solid)
    return solid


def ball(radius):
    return BRepPrimAPI_MakeSphere(radius).Shape()


def moved(shape, x):
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(x, 0, 0))
    return BRepBuilderAPI_Transform(shape, move, True).Shape()


def together(*shapes):
    builder, compound = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound


class Drawing:
    """A document of named, coloured, placed shapes."""

    def __init__(self):
        Message.DefaultMessenger_s().ChangePrinters().Clear()
        self.document = TDocStd_Document(TCollection_ExtendedString("drawing"))
        self.shapes = XCAFDoc_DocumentTool.ShapeTool_s(self.document.Main())
        self.colours = XCAFDoc_DocumentTool.ColorTool_s(self.document.Main())

    def add(self, shape, name, colour=None):
        """A label of a shape on its own; sRGB colour."""
        label = self.shapes.AddShape(shape, False)
        self._describe(label, name, colour)
        return label

    def assembly(self, name):
        label = self.shapes.NewShape()
        self._describe(label, name, None)
        return label

    def place(self, whole, part, x, turn=0.0, colour=None):
        """`part` in `whole`, turned about z by `turn` and then shifted by `x`."""
        move, spin = gp_Trsf(), gp_Trsf()
        spin.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), turn)
        move.SetTranslation(gp_Vec(x, 0, 0))
        label = self.shapes.AddComponent(whole, part, TopLoc_Location(move.Multiplied(spin)))
        self._describe(label, None, colour)
        self.shapes.UpdateAssemblies()

    def paint_face(self, shape, which, colour):
        self.colours.SetColor(list(faces_of(shape))[which], _colour(colour), SURFACE)

    def _describe(self, label, name, colour):
        if name is not None:
            TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
        if colour is not None:
            self.colours.SetColor(label, _colour(colour), SURFACE)

    def step(self, path: Path, unit="MM"):
        Interface_Static.SetCVal_s("write.step.unit", unit)
        writer = STEPCAFControl_Writer()
        assert writer.Transfer(self.document, STEPControl_StepModelType.STEPControl_AsIs)
        writer.Write(str(path))
        Interface_Static.SetCVal_s("write.step.unit", "MM")
        return path

    def iges(self, path: Path):
        writer = IGESCAFControl_Writer()
        writer.Transfer(self.document)
        writer.Write(str(path))
        return path


def brep(shape, path: Path):
    BRepTools.Write_s(shape, str(path))
    return path


def _colour(srgb):
    return Quantity_Color(*srgb, Quantity_TypeOfColor.Quantity_TOC_sRGB)
