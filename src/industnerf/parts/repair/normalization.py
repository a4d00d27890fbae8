"""The frame in which cleaning works: the part's box is centered and has a diagonal of 1.

Tolerances are then plain numbers, and a part of 1e-6 mm, or 1e7 mm from the origin, loses no
digit that its file holds.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart


@dataclass(frozen=True)
class Normalization:
    center: Float[np.ndarray, "3"]  # mm
    diagonal: float  # mm

    def normalize(self, mesh: Mesh) -> Mesh:
        """`mesh` from mm to diagonals about the center."""
        return Mesh((mesh.vertices - self.center) / self.diagonal, mesh.faces, mesh.finish)

    def denormalize(self, mesh: Mesh) -> Mesh:
        """The inverse of `unit`, but for rounding: 2e-16 of the diagonal or of the coordinate."""
        return Mesh(mesh.vertices * self.diagonal + self.center, mesh.faces, mesh.finish)


def fit_normalization(solids: list[Mesh]) -> Normalization:
    """The frame of finite `solids` whose vertices are all used; raises BadPart if it is a point."""
    low = np.min([solid.vertices.min(axis=0) for solid in solids], axis=0)
    high = np.max([solid.vertices.max(axis=0) for solid in solids], axis=0)
    with np.errstate(over="ignore"):  # an infinite diagonal is refused below
        diagonal = math.hypot(*(high - low))
    if not 0 < diagonal < math.inf:
        raise BadPart(f"its bounding box has a diagonal of {diagonal:g} mm")
    return Normalization(low + (high - low) / 2, diagonal)
