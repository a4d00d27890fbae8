"""Colours and names that a CAD document keeps at its labels."""

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

from industnerf.parts.brep import faces_of

NAMELESS = ("SOLID", "COMPOUND", "SHELL", "=>")  # what the kernel calls what has no name


@dataclass(frozen=True)
class Paint:
    """The colours within one part: of its faces, or of its solids."""

    known: dict[int, list[tuple[TopoDS_Shape, Float64[np.ndarray, "3"]]]]

    @staticmethod
    def none() -> "Paint":
        """A part without colours."""
        return Paint({})

    @staticmethod
    def of(label: TDF_Label) -> "Paint":
        """The colours of the faces and solids of the part at `label`."""
        known: dict[int, list] = {}
        parts = Sequence_TDF_Label()
        XCAFDoc_ShapeTool.GetSubShapes_s(label, parts)
        shapes = [(XCAFDoc_ShapeTool.GetShape_s(part), colour_of(part)) for part in parts]
        # Whole solids first, so that a face's own colour, which comes later, goes before.
        for shape, colour in sorted(shapes, key=lambda pair: _is_face(pair[0])):
            if colour is not None:
                for face in faces_of(shape):
                    known.setdefault(hash(face), []).append((face, colour))
        return Paint(known)

    def on(self, face: TopoDS_Shape) -> Float64[np.ndarray, "3"]:
        """The albedo of `face`; NaN if none is stated."""
        same = [colour for other, colour in self.known.get(hash(face), []) if other.IsSame(face)]
        return same[-1] if same else np.full(3, np.nan)


def colour_of(label: TDF_Label) -> Float64[np.ndarray, "3"] | None:
    """The albedo at `label`; None if it states none."""
    colour = Quantity_Color()  # linear inside: the kernel decodes the sRGB of the file
    for kind in (XCAFDoc_ColorType.XCAFDoc_ColorSurf, XCAFDoc_ColorType.XCAFDoc_ColorGen):
        if XCAFDoc_ColorTool.GetColor_s(label, kind, colour):
            return np.array(colour.Values(Quantity_TypeOfColor.Quantity_TOC_RGB))
    return None


def name_of(label: TDF_Label) -> str:
    """The name at `label`, or `solid`."""
    name = TDataStd_Name()
    # Asked first: to search for a name that is not there ends the process.
    if not label.IsAttribute(TDataStd_Name.GetID_s()):
        return "solid"
    label.FindAttribute(TDataStd_Name.GetID_s(), name)
    text = name.Get().ToExtString().strip()
    return "solid" if not text or text.startswith(NAMELESS) else text


def _is_face(shape: TopoDS_Shape) -> bool:
    return shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_FACE
