"""The recipe of a part: what a family lists, and how its mesh is made."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal

from build123d import Shape

from industnerf.artifacts.part import Mesh
from industnerf.parts.catalogue.appearances import APPEARANCES
from industnerf.parts.catalogue.catalogues import REFERENCE_REFINEMENT, MeshPart
from industnerf.parts.validation.checks import volume_mm3


@dataclass(frozen=True)
class MeshBoolean:
    """Shapes to be joined, and then cut, as meshes.

    For parts whose booleans OpenCASCADE loses: it can drop a rim or a blade and still call the
    rest valid.
    """

    join: list[Shape]
    cut: list[Shape]


@dataclass(frozen=True)
class Assembly:
    """Bodies of several finishes, by the name of the finish (see `appearances.APPEARANCES`)."""

    bodies: dict[str, Shape | MeshBoolean]


Drawing = Shape | MeshBoolean | Assembly


@dataclass(frozen=True)
class Recipe:
    """One part: its name, and how to draw it.

    `id` never changes once published: it names files, seeds and splits.  `designation` is the
    standard and the size; "-like" marks proportions that are ours, not the standard's table.
    """

    id: str
    designation: str
    library: Literal["build123d", "bd_warehouse", "py_gearworks"]
    draw: Callable[..., Drawing]
    parameters: dict[str, float | int | str]  # the arguments of `draw`; lengths in mm
    finish: str = "steel"  # of whatever the drawing gives none
    refinement: int = 1  # than the usual mesh, for thin blades and the like
    origin: ClassVar[str] = "embedded"

    def drawing(self) -> Assembly:
        """The drawing, every body with its finish."""
        shape = self.draw(**self.parameters)
        return shape if isinstance(shape, Assembly) else Assembly({self.finish: shape})

    def exact_drawing(self) -> Assembly | None:
        """The drawing, or None if some of it is drawn as a mesh and has no exact surface."""
        drawing = self.drawing()
        is_exact = not any(isinstance(body, MeshBoolean) for body in drawing.bodies.values())
        return drawing if is_exact else None

    def build_mesh(self) -> MeshPart:
        """The drawing as a mesh, and its exact volume if it is one solid."""
        from industnerf.parts.catalogue.tessellate import (  # which imports this module
            single_solid,
            tessellate,
        )

        drawing = self.drawing()
        tessellated = tessellate(drawing, self.refinement)
        mesh = Mesh(tessellated.vertices, tessellated.faces, tessellated.finish)
        finishes = tuple(APPEARANCES[name] for name in drawing.bodies)
        solid = single_solid(drawing)
        if solid is not None:
            return MeshPart(mesh, finishes, "b-rep", float(solid.volume))
        fine = tessellate(drawing, REFERENCE_REFINEMENT * self.refinement)
        volume = volume_mm3(fine.vertices, fine.faces)
        return MeshPart(mesh, finishes, "finer mesh", volume)
