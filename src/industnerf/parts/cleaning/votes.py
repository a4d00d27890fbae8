"""From which side each face is seen: the vote of many rays from outside."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from industnerf.artifacts.part import Mesh
from industnerf.geometry.beams import beams
from industnerf.geometry.raycast import Scene
from industnerf.parts.checks import doubled_normals

VIEWS, ACROSS = 100, 96


@dataclass(frozen=True)
class Votes:
    """Rays that met each face from its front, and from behind."""

    front: Int[np.ndarray, "m"]
    behind: Int[np.ndarray, "m"]
    density: float  # rays that would meet a unit of area of a convex solid that stood alone

    def against(self, turned: Bool[np.ndarray, "m"]) -> Int[np.ndarray, "m"]:
        """The rays that would meet each face from behind, were those `turned` turned."""
        return np.where(turned, self.front, self.behind)

    def share_behind(self, turned: Bool[np.ndarray, "m"]) -> float:
        """Of all rays that hit, the share that meets a face from behind, likewise."""
        return float(self.against(turned).sum() / max((self.front + self.behind).sum(), 1))


def cast_votes(mesh: Mesh) -> Votes:
    """The votes of `VIEWS` beams of `ACROSS`**2 rays each."""
    scene = Scene(mesh.vertices, mesh.faces)
    width = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    # Cauchy: the mean shadow of a convex solid is a quarter of its surface.
    density = VIEWS * (ACROSS / width) ** 2 / 4
    normals, n = doubled_normals(mesh.vertices, mesh.faces), len(mesh.faces)
    front, behind = np.zeros(n, np.int64), np.zeros(n, np.int64)
    for origins, direction in beams(mesh.vertices, VIEWS, ACROSS):
        face = scene.cast(origins, np.broadcast_to(direction, origins.shape)).face
        hits = np.bincount(face[face >= 0], minlength=n)
        away = normals @ direction > 0
        front += np.where(away, 0, hits)
        behind += np.where(away, hits, 0)
    return Votes(front, behind, density)
