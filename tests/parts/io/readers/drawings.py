"""STEP, IGES and BREP files drawn and written with the CAD kernel itself."""

from pathlib import Path

from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_Transform,
)
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakeHalfSpace,
    BRepPrimAPI_MakeSphere,
)
from OCP.BRepTools import BRepTools
from OCP.Geom import Geom_Circle
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
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Solid
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

from industnerf.parts.io.occt_triangulation import faces_of

SURFACE = XCAFDoc_ColorType.XCAFDoc_ColorSurf


def box(x=30.0, y=20.0, z=10.0):
    return BRepPrimAPI_MakeBox(x, y, z).Shape()


def half_space():
    """A solid without end: everything below z = 0."""
    plane = BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Face()
    return BRepPrimAPI_MakeHalfSpace(plane, gp_Pnt(0, 0, -1)).Solid()


def empty_solid():
    """A solid without a shell."""
    solid = TopoDS_Solid()
    BRep_Builder().MakeSolid(solid)
    return solid


def ball(radius):
    return BRepPrimAPI_MakeSphere(radius).Shape()


def cylinder_with_a_cone_for_its_wall(radius, height, upper_radius):
    """Invalid: the upper edge is a smaller circle than the cylinder's wall ends in."""
    solid, builder = BRepPrimAPI_MakeCylinder(radius, height).Shape(), BRep_Builder()
    explorer = TopExp_Explorer(solid, TopAbs_ShapeEnum.TopAbs_EDGE)
    while explorer.More():
        edge = TopoDS.Edge(explorer.Current())
        curve = BRep_Tool.Curve_s(edge, 0.0, 1.0)
        if isinstance(curve, Geom_Circle) and curve.Circ().Location().Z() > height / 2:
            circle = curve.Circ()
            circle.SetRadius(upper_radius)
            builder.UpdateEdge(edge, Geom_Circle(circle), 1e-7)
        explorer.Next()
    return solid


def plate_with_a_hole(side, hole_side):
    """Invalid: the hole runs around as the outline does."""

    def square(low, high):
        corners = [(low, low), (high, low), (high, high), (low, high)]
        points = [gp_Pnt(x, y, 0) for x, y in corners]
        return BRepBuilderAPI_MakePolygon(*points, True).Wire()

    plane = gp_Pln(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))
    plate = BRepBuilderAPI_MakeFace(plane, square(0, side), False)
    plate.Add(square(1, 1 + hole_side))
    return plate.Face()


def translated(shape, x):
    transform = gp_Trsf()
    transform.SetTranslation(gp_Vec(x, 0, 0))
    return BRepBuilderAPI_Transform(shape, transform, True).Shape()


def compound_of(*shapes):
    builder, compound = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound


class Drawing:
    """A document of named, colored, placed shapes."""

    def __init__(self):
        Message.DefaultMessenger_s().ChangePrinters().Clear()
        self.document = TDocStd_Document(TCollection_ExtendedString("drawing"))
        self.shapes = XCAFDoc_DocumentTool.ShapeTool_s(self.document.Main())
        self.colors = XCAFDoc_DocumentTool.ColorTool_s(self.document.Main())

    def add(self, shape, name, color=None):
        """A label of a shape on its own; sRGB color."""
        label = self.shapes.AddShape(shape, False)
        self._describe(label, name, color)
        return label

    def assembly(self, name):
        label = self.shapes.NewShape()
        self._describe(label, name, None)
        return label

    def add_component(self, assembly, part, x, angle=0.0, color=None):
        """`part` in `whole`, turned about z by `turn` and then shifted by `x`."""
        translation, rotation = gp_Trsf(), gp_Trsf()
        rotation.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), angle)
        translation.SetTranslation(gp_Vec(x, 0, 0))
        label = self.shapes.AddComponent(
            assembly, part, TopLoc_Location(translation.Multiplied(rotation))
        )
        self._describe(label, None, color)
        self.shapes.UpdateAssemblies()

    def color_face(self, shape, face_index, color):
        self.colors.SetColor(list(faces_of(shape))[face_index], _color(color), SURFACE)

    def _describe(self, label, name, color):
        if name is not None:
            TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
        if color is not None:
            self.colors.SetColor(label, _color(color), SURFACE)

    def write_step(self, path: Path, unit="MM"):
        Interface_Static.SetCVal_s("write.step.unit", unit)
        writer = STEPCAFControl_Writer()
        assert writer.Transfer(self.document, STEPControl_StepModelType.STEPControl_AsIs)
        writer.Write(str(path))
        Interface_Static.SetCVal_s("write.step.unit", "MM")
        return path

    def write_iges(self, path: Path):
        writer = IGESCAFControl_Writer()
        writer.Transfer(self.document)
        writer.Write(str(path))
        return path


def write_brep(shape, path: Path):
    BRepTools.Write_s(shape, str(path))
    return path


def _color(srgb):
    return Quantity_Color(*srgb, Quantity_TypeOfColor.Quantity_TOC_sRGB)
