"""From which side each face is seen: the vote of many rays from outside."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from industnerf.artifacts.part import Mesh
from industnerf.geometry.raycast import RaycastingScene, parallel_ray_bundles
from industnerf.parts.validation.checks import double_area_normals

NUM_BEAMS, RAYS_PER_SIDE = 100, 96


@dataclass(frozen=True)
class OrientationVotes:
    """Rays that met each face from its front, and from behind."""

    front: Int[np.ndarray, "m"]
    back: Int[np.ndarray, "m"]
    density: float  # rays that would meet a unit of area of a convex solid that stood alone

    def back_votes(self, flipped: Bool[np.ndarray, "m"]) -> Int[np.ndarray, "m"]:
        """The rays that would meet each face from behind, were those `turned` turned."""
        return np.where(flipped, self.front, self.back)

    def back_share(self, flipped: Bool[np.ndarray, "m"]) -> float:
        """Of all rays that hit, the share that meets a face from behind, likewise."""
        return float(self.back_votes(flipped).sum() / max((self.front + self.back).sum(), 1))


def ray_votes(mesh: Mesh) -> OrientationVotes:
    """The votes of `VIEWS` beams of `ACROSS`**2 rays each."""
    scene = RaycastingScene(mesh.vertices, mesh.faces)
    width = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    # Cauchy: the mean shadow of a convex solid is a quarter of its surface.
    density = NUM_BEAMS * (RAYS_PER_SIDE / width) ** 2 / 4
    normals, n = double_area_normals(mesh.vertices, mesh.faces), len(mesh.faces)
    front, back = np.zeros(n, np.int64), np.zeros(n, np.int64)
    for origins, direction in parallel_ray_bundles(mesh.vertices, NUM_BEAMS, RAYS_PER_SIDE):
        face = scene.cast(origins, np.broadcast_to(direction, origins.shape)).face
        hits = np.bincount(face[face >= 0], minlength=n)
        is_back = normals @ direction > 0
        front += np.where(is_back, 0, hits)
        back += np.where(is_back, hits, 0)
    return OrientationVotes(front, back, density)
