"""The cube around a part's bounding box: the frame of methods that learn from other parts."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True)
class BoundingCube:
    """Center of a bounding box and its longest edge, mm; the axes are the part's own."""

    center_mm: Float[np.ndarray, "3"]
    edge_mm: float

    @staticmethod
    def of(vertices: Float[np.ndarray, "n 3"]) -> "BoundingCube":
        """The cube around `vertices` (mm)."""
        lo, hi = vertices.min(axis=0), vertices.max(axis=0)
        return BoundingCube((lo + hi) / 2, float((hi - lo).max()))

    def to_unit(self, points_mm: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """From the part's frame to the unit cube [-1/2, 1/2]^3."""
        return (points_mm - self.center_mm) / self.edge_mm

    def to_mm(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """From the unit cube to the part's frame."""
        return points * self.edge_mm + self.center_mm
