"""Colors and names that a CAD document keeps at its labels."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from OCP.collections import Sequence_TDF_Label
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc_ColorTool, XCAFDoc_ColorType, XCAFDoc_ShapeTool

from industnerf.parts.io.occt_triangulation import faces_of

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
