"""What a family hands over to be baked."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from build123d import Shape


@dataclass(frozen=True)
class MeshBoolean:
    """Shapes to be joined, and then cut, as meshes.

    For parts whose booleans OpenCASCADE loses: it can drop a rim or a blade and still call the
    rest valid.
    """

    join: list[Shape]
    cut: list[Shape]


@dataclass(frozen=True)
class Recipe:
    """One part: its name, and how to draw it.

    `id` never changes once published: it names files, seeds and splits.  `designation` is the
    standard and the size; "-like" marks proportions that are ours, not the standard's table.
    """

    id: str
    designation: str
    library: Literal["build123d", "bd_warehouse", "py_gearworks"]
    draw: Callable[..., Shape | MeshBoolean]
    parameters: dict[str, float | int | str]  # the arguments of `draw`; lengths in mm

    def shape(self) -> Shape | MeshBoolean:
        return self.draw(**self.parameters)
