"""What a family hands over to be baked."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal

from build123d import Shape

from industnerf.artifacts.part import Mesh
from industnerf.parts.checks import volume_mm3
from industnerf.parts.finishes import FINISHES
from industnerf.parts.meshed import FINER, Meshed


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
    """Bodies of several finishes, by the name of the finish (see `finishes.FINISHES`)."""

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
    finer: int = 1  # than the usual mesh, for thin blades and the like
    origin: ClassVar[str] = "embedded"

    def drawing(self) -> Assembly:
        """The drawing, every body with its finish."""
        drawn = self.draw(**self.parameters)
        return drawn if isinstance(drawn, Assembly) else Assembly({self.finish: drawn})

    def exact_drawing(self) -> Assembly | None:
        """The drawing, or None if some of it is drawn as a mesh and has no exact surface."""
        drawing = self.drawing()
        exact = not any(isinstance(body, MeshBoolean) for body in drawing.bodies.values())
        return drawing if exact else None

    def meshed(self) -> Meshed:
        """The drawing as a mesh, and its exact volume if it is one solid."""
        from industnerf.parts.tessellate import only_solid, tessellate  # which imports this module

        drawing = self.drawing()
        drawn = tessellate(drawing, self.finer)
        mesh = Mesh(drawn.vertices, drawn.faces, drawn.finish)
        finishes = tuple(FINISHES[name] for name in drawing.bodies)
        solid = only_solid(drawing)
        if solid is not None:
            return Meshed(mesh, finishes, "b-rep", float(solid.volume))
        finer = tessellate(drawing, FINER * self.finer)
        exact = volume_mm3(finer.vertices, finer.faces)
        return Meshed(mesh, finishes, "finer mesh", exact)
