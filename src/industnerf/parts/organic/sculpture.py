"""A part of the non-industrial set: a name, a formula and a palette."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from industnerf.artifacts.finish import Finish
from industnerf.artifacts.part import Mesh
from industnerf.parts import checks
from industnerf.parts.meshed import FINER, Meshed

GRID = 1024.0  # coordinates are whole multiples of 1/1024 mm: a third less to store


@dataclass(frozen=True)
class Sculpture:
    """One part: its name, and the formula that draws it.

    `draw(edge_mm, **parameters)` gives a mesh with edges of about `edge_mm`, the finish of every
    face an index into `palette`.
    """

    id: str  # never changes once published
    designation: str
    draw: Callable[..., Mesh]
    parameters: dict[str, float | int | str]  # of the formula; lengths in mm
    edge_mm: float
    palette: tuple[Finish, ...]
    origin: ClassVar[str] = "organic"
    library: ClassVar[str] = "manifold3d"

    def meshed(self) -> Meshed:
        """The mesh, and the volume of one of half the edges: chords miss the curve by a quarter."""
        mesh, finer = (
            self.draw(self.edge_mm / scale, **self.parameters) for scale in (1.0, FINER**0.5)
        )
        exact = checks.volume_mm3(finer.vertices, finer.faces)
        return Meshed(_on_grid(mesh), self.palette, "finer mesh", exact)


def _on_grid(mesh: Mesh) -> Mesh:
    """Vertices at multiples of 1 / `GRID`; those that fall together become one."""
    places, place = np.unique(np.round(mesh.vertices * GRID), axis=0, return_inverse=True)
    faces = place.reshape(-1)[mesh.faces].astype(np.int32)
    kept = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return Mesh(places / GRID, faces[kept], mesh.finish[kept])


def glaze(name: str, red: float, green: float, blue: float, roughness: float = 0.5) -> Finish:
    """A matte or glossy coat of paint, its colour linear in [0, 0.72] as `finishes` has it."""
    return Finish(name, (red, green, blue), 0.0, roughness)
