"""Ray intersections with the surface of a part, and the normals there."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float32, Int, Int32

from industnerf.artifacts.part import Mesh
from industnerf.capture.normals import corner_normals, face_normals
from industnerf.geometry.raycast import RaycastingScene


@dataclass(frozen=True)
class SurfacePoints:
    """Where the rays from one camera that hit the part meet it."""

    ray: Int[np.ndarray, "hits"]  # which rays
    t: Float32[np.ndarray, "hits"]  # in lengths of their directions
    face: Int32[np.ndarray, "hits"]
    uv: Float32[np.ndarray, "hits 2"]  # barycentric weights of the face's 2nd and 3rd corner
    normal: Float32[np.ndarray, "3 hits"]  # for shading, towards the camera; at most 1 long
    is_backface: Bool[np.ndarray, "hits"]  # the face is seen from its back
    camera_center: Float[np.ndarray, "3"]


class Surface:
    """A mesh, ready to be looked at from anywhere.  A face has the side that the viewer sees."""

    def __init__(self, mesh: Mesh, crease_deg: float) -> None:
        self.vertices, triangles = mesh.vertices, mesh.triangles
        self.scene = RaycastingScene(mesh.vertices, mesh.faces)
        self._corners = triangles
        self._face_normals = face_normals(triangles)
        self._plane_offset = np.einsum("ij,ij->i", self._face_normals, triangles[:, 0])
        # n(u, v) = n0 + u (n1 - n0) + v (n2 - n0): n0 and the two differences
        self._normals = corner_normals(mesh.vertices, mesh.faces, crease_deg)
        self._normals[:, 1:] -= self._normals[:, :1]

    def intersect(
        self, camera_center: Float[np.ndarray, "3"], directions: Float32[np.ndarray, "rays 3"]
    ) -> SurfacePoints:
        """The first intersections of the rays from `camera_center`."""
        from industnerf.geometry.ray_packets import interpolate  # Warp is slow to import

        hits = self.scene.cast_from(camera_center, directions)
        is_backface = self._face_normals @ camera_center < self._plane_offset
        is_backface = is_backface.take(hits.face)
        normal = interpolate(hits, self._normals)
        normal *= np.where(is_backface, np.float32(-1), np.float32(1))
        return SurfacePoints(*hits, normal, is_backface, camera_center)

    def offset_along_normal(self, hits: SurfacePoints) -> Float[np.ndarray, "hits 3"]:
        """The points (mm) on the round surface that the facets stand for, never below these.

        A ray from a facet of a round surface towards a low lamp would meet the next facet.  So
        each point goes to the mean of its feet on the planes across the corners' normals, where
        these lie above -- Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II (2021).
        """
        corners = self._corners.take(hits.face, axis=0)
        weights = np.concatenate([1 - hits.uv.sum(axis=1, keepdims=True), hits.uv], axis=1)
        positions = np.einsum("ni,nij->nj", weights, corners)
        by_axis = np.ascontiguousarray(self._normals.take(hits.face, axis=0).transpose(2, 1, 0))
        normals = by_axis.transpose(1, 2, 0)
        normals[1:] += normals[0]
        normals[:, hits.is_backface] *= -1
        offset = np.zeros_like(positions)
        for corner, normal, weight in zip(corners.swapaxes(0, 1), normals, weights.T, strict=True):
            depth_below = np.minimum(np.einsum("nj,nj->n", positions - corner, normal), 0)
            offset -= (weight * depth_below)[:, None] * normal
        return positions + offset
