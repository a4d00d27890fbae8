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
        # n(u, v) = n0 + u (n1 - n0) + v (n2 - n0): for each axis n0 and the two differences
        normals = corner_normals(mesh.vertices, mesh.faces, crease_deg)
        normals[:, 1:] -= normals[:, :1]
        self._normals = np.ascontiguousarray(normals.transpose(2, 1, 0))

    def intersect(
        self, camera_center: Float[np.ndarray, "3"], directions: Float32[np.ndarray, "rays 3"]
    ) -> SurfacePoints:
        """The first intersections of the rays from `camera_center`."""
        ray, t, face, uv = self.scene.cast_from(camera_center, directions)
        (u, v), normal = uv.T, np.empty((3, len(ray)), np.float32)
        for axis, (n, du, dv) in enumerate(self._normals):
            normal[axis] = n.take(face) + u * du.take(face) + v * dv.take(face)
        is_backface = (self._face_normals @ camera_center < self._plane_offset).take(face)
        normal[:, is_backface] *= -1
        return SurfacePoints(ray, t, face, uv, normal, is_backface, camera_center)

    def offset_along_normal(self, hits: SurfacePoints) -> Float[np.ndarray, "hits 3"]:
        """The points (mm) on the round surface that the facets stand for, never below these.

        A ray from a facet of a round surface towards a low lamp would meet the next facet.  So
        each point goes to the mean of its feet on the planes across the corners' normals, where
        these lie above -- Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II (2021).
        """
        corners = self._corners.take(hits.face, axis=0)
        weights = np.concatenate([1 - hits.uv.sum(axis=1, keepdims=True), hits.uv], axis=1)
        positions = np.einsum("ni,nij->nj", weights, corners)
        normals = self._normals.take(hits.face, axis=2).transpose(1, 2, 0)
        normals[1:] += normals[0]
        normals[:, hits.is_backface] *= -1
        offset = np.zeros_like(positions)
        for corner, normal, weight in zip(corners.swapaxes(0, 1), normals, weights.T, strict=True):
            depth_below = np.minimum(np.einsum("nj,nj->n", positions - corner, normal), 0)
            offset -= (weight * depth_below)[:, None] * normal
        return positions + offset
