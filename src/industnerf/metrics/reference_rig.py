"""The reference rig, which decides what of the surface is visible and so is scored."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from industnerf.artifacts.part import Mesh
from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.geometry.visibility import visible_from
from industnerf.metrics.nearest_distances import distance_to_nearest
from industnerf.schema import EvaluateParams

SURFACE_TOLERANCE = 1e-4  # a sample of the surface lies this close to it, in diagonals


@dataclass(frozen=True)
class ReferenceSurface:
    """A part's true surface, and the scale in which its bounding-box diagonal is 1."""

    mesh: Mesh

    @property
    def center(self) -> Float[np.ndarray, "3"]:
        """Center of the bounding box, mm."""
        return (self.mesh.vertices.min(axis=0) + self.mesh.vertices.max(axis=0)) / 2

    @property
    def diagonal_mm(self) -> float:
        return float(np.linalg.norm(np.ptp(self.mesh.vertices, axis=0)))

    def normalize(self, points_mm: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Points in diagonals, about the center."""
        return (points_mm.astype(np.float64) - self.center) / self.diagonal_mm


class ReferenceRig:
    """Cameras all round the part: the same for every method, whatever views it was given."""

    def __init__(self, reference: ReferenceSurface, settings: EvaluateParams) -> None:
        bounding_radius = np.linalg.norm(reference.mesh.vertices - reference.center, axis=1).max()
        self._reference = reference
        radius_mm = settings.visibility_radius * bounding_radius
        directions = fibonacci_sphere(settings.visibility_views)
        self._camera_centers = reference.center + radius_mm * directions
        self._scene = RaycastingScene(reference.mesh.vertices, reference.mesh.faces)

    def is_visible(
        self, points_mm: Float[np.ndarray, "n 3"], depth: float = SURFACE_TOLERANCE
    ) -> Bool[np.ndarray, "n"]:
        """Whether a camera sees the point, or one at most `depth` diagonals before it."""
        tolerance = depth * self._reference.diagonal_mm
        return visible_from(
            self._scene, points_mm.astype(np.float64), self._camera_centers, tolerance
        )


def evaluated_mask(
    rig: ReferenceRig,
    predicted_mm: Float[np.ndarray, "n 3"],
    truth_mm: Float[np.ndarray, "m 3"],
    truth_visible: Bool[np.ndarray, "m"],
    hidden_depth: float,
) -> Bool[np.ndarray, "n"]:
    """Which predicted points are compared with the visible surface.

    One is left out only if, as seen from every camera, it lies more than `hidden_depth` diagonals
    behind the true surface, AND it is nearer to the hidden truth than to the visible truth.
    """
    mask = np.ones(len(predicted_mm), bool)
    if truth_visible.all():
        return mask
    deep = np.flatnonzero(~rig.is_visible(predicted_mm, hidden_depth))
    to_visible = distance_to_nearest(predicted_mm[deep], truth_mm[truth_visible])
    to_hidden = distance_to_nearest(predicted_mm[deep], truth_mm[~truth_visible])
    mask[deep[to_hidden < to_visible]] = False
    return mask
