"""Only what can be seen is scored: the reference rig, and one rule for both sides."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from industnerf.artifacts.part import Mesh
from industnerf.geometry.raycast import Scene
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.geometry.visibility import seen_from
from industnerf.metrics.gaps import nearest
from industnerf.schema import EvaluateParams

ON_SURFACE = 1e-4  # a sample of the surface lies this close to it, in diagonals


@dataclass(frozen=True)
class Frame:
    """A part's true surface, and the scale in which its bounding-box diagonal is 1."""

    mesh: Mesh

    @property
    def centre(self) -> Float[np.ndarray, "3"]:
        """Centre of the bounding box, mm."""
        return (self.mesh.vertices.min(axis=0) + self.mesh.vertices.max(axis=0)) / 2

    @property
    def diagonal_mm(self) -> float:
        return float(np.linalg.norm(np.ptp(self.mesh.vertices, axis=0)))

    def unit(self, points_mm: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Points in diagonals, about the centre."""
        return (points_mm.astype(np.float64) - self.centre) / self.diagonal_mm


class Rig:
    """The reference rig: the same eyes for every method, whatever views it was given."""

    def __init__(self, frame: Frame, settings: EvaluateParams) -> None:
        reach = np.linalg.norm(frame.mesh.vertices - frame.centre, axis=1).max()
        self._frame = frame
        self._eyes = frame.centre + settings.rig_radius * reach * fibonacci_sphere(settings.rig)
        self._scene = Scene(frame.mesh.vertices, frame.mesh.faces)

    def sees(
        self, points_mm: Float[np.ndarray, "n 3"], depth: float = ON_SURFACE
    ) -> Bool[np.ndarray, "n"]:
        """Whether an eye sees the point, or one at most `depth` diagonals before it."""
        tolerance = depth * self._frame.diagonal_mm
        return seen_from(self._scene, points_mm.astype(np.float64), self._eyes, tolerance)


def scored(
    rig: Rig,
    predicted_mm: Float[np.ndarray, "n 3"],
    truth_mm: Float[np.ndarray, "m 3"],
    truth_visible: Bool[np.ndarray, "m"],
    hidden: float,
) -> Bool[np.ndarray, "n"]:
    """Which predicted points count against the visible surface.

    One is left out only if as seen from every eye it lies more than `hidden` diagonals behind the
    true surface, AND it is nearer to the hidden truth than to the visible truth.
    """
    keep = np.ones(len(predicted_mm), bool)
    if truth_visible.all():
        return keep
    inside = np.flatnonzero(~rig.sees(predicted_mm, hidden))
    to_visible = nearest(predicted_mm[inside], truth_mm[truth_visible])
    to_hidden = nearest(predicted_mm[inside], truth_mm[~truth_visible])
    keep[inside[to_hidden < to_visible]] = False
    return keep
