"""A part of the non-industrial set: a name, a formula and a palette."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.parts.catalogue.catalogues import REFERENCE_REFINEMENT, MeshPart
from industnerf.parts.validation import checks

GRID_PER_MM = 1024.0  # coordinates are whole multiples of 1/1024 mm: a third less to store


@dataclass(frozen=True)
class ProceduralRecipe:
    """One part: its name, and the formula that draws it.

    `draw(edge_mm, **parameters)` gives a mesh with edges of about `edge_mm`, the finish of every
    face an index into `palette`.
    """

    id: str  # never changes once published
    designation: str
    draw: Callable[..., Mesh]
    parameters: dict[str, float | int | str]  # of the formula; lengths in mm
    edge_mm: float
    palette: tuple[Appearance, ...]
    origin: ClassVar[str] = "organic"
    library: ClassVar[str] = "manifold3d"

    def build_mesh(self) -> MeshPart:
        """The mesh, and the volume of one of half the edges: chords miss the curve by a quarter."""
        mesh, fine = (
            self.draw(self.edge_mm / scale, **self.parameters)
            for scale in (1.0, REFERENCE_REFINEMENT**0.5)
        )
        volume = checks.volume_mm3(fine.vertices, fine.faces)
        return MeshPart(_snap_to_grid(mesh), self.palette, "finer mesh", volume)


def _snap_to_grid(mesh: Mesh) -> Mesh:
    """Vertices at multiples of 1 / `GRID_PER_MM`; those that fall together become one."""
    grid_points, point_index = np.unique(
        np.round(mesh.vertices * GRID_PER_MM), axis=0, return_inverse=True
    )
    faces = point_index.reshape(-1)[mesh.faces].astype(np.int32)
    is_kept = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return Mesh(grid_points / GRID_PER_MM, faces[is_kept], mesh.finish[is_kept])


def paint_appearance(
    name: str, red: float, green: float, blue: float, roughness: float = 0.5
) -> Appearance:
    """A matte or glossy coat of paint, its color linear in [0, 0.72] as `APPEARANCES` has it."""
    return Appearance(name, (red, green, blue), 0.0, roughness)
