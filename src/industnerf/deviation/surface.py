"""Nearest points of a triangle surface, and on which side of it a point lies."""

from dataclasses import dataclass
from typing import no_type_check  # compiled, not called: there is nothing to check

import numpy as np
import warp as wp
from jaxtyping import Float, Int

from industnerf.geometry.warp_runtime import init_warp

init_warp()
wp.set_module_options({"enable_backward": False})

SIGN_EPSILON = 1e-3  # share of a triangle within which a nearest point counts as on its border


@wp.kernel
@no_type_check
def _nearest(
    mesh: wp.uint64,
    points: wp.array(dtype=wp.vec3),
    max_distance: wp.float32,
    nearest: wp.array(dtype=wp.vec3),
    normal: wp.array(dtype=wp.vec3),
    sign: wp.array(dtype=wp.float32),
):
    i = wp.tid()
    query = wp.mesh_query_point_sign_normal(mesh, points[i], max_distance, SIGN_EPSILON)
    nearest[i] = wp.mesh_eval_position(mesh, query.face, query.u, query.v)
    normal[i] = wp.mesh_eval_face_normal(mesh, query.face)
    sign[i] = query.sign


@dataclass(frozen=True)
class Nearest:
    """The points of the surface that are nearest to others."""

    points: Float[np.ndarray, "n 3"]
    normals: Float[np.ndarray, "n 3"]  # of the faces that they lie on; unit vectors
    signed_distance: Float[np.ndarray, "n"]  # positive outside


class Surface:
    """A triangle mesh that answers where its nearest points are.

    Computed in float32 about its center: off by some 1e-6 of what lies between.
    """

    def __init__(self, vertices: Float[np.ndarray, "v 3"], faces: Int[np.ndarray, "f 3"]) -> None:
        self.center = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
        self.vertices, self.faces = vertices, faces
        corners = (vertices - self.center).astype(np.float32)
        self._reach = float(np.linalg.norm(corners, axis=1).max())
        self._device = wp.get_device("cpu")
        self._mesh = wp.Mesh(
            wp.array(corners, dtype=wp.vec3, device=self._device),
            wp.array(faces.astype(np.int32).ravel(), dtype=wp.int32, device=self._device),
        )

    @property
    def diagonal(self) -> float:
        """Of the bounding box."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0)))

    def nearest(self, points: Float[np.ndarray, "n 3"]) -> Nearest:
        """The nearest point of the surface to each of `points`."""
        centered = points - self.center
        # the search is bounded by more than any distance can be
        max_distance = 2 * (1 + np.linalg.norm(centered, axis=1).max(initial=0) + self._reach)
        queries = wp.array(centered.astype(np.float32), dtype=wp.vec3, device=self._device)
        count = len(points)
        nearest, normal = (wp.empty(count, dtype=wp.vec3, device=self._device) for _ in range(2))
        sign = wp.empty(count, dtype=wp.float32, device=self._device)
        arguments = [self._mesh.id, queries, max_distance, nearest, normal, sign]
        wp.launch(_nearest, count, arguments, device=self._device)
        where = nearest.numpy().astype(np.float64)
        distance = np.linalg.norm(centered - where, axis=1)
        return Nearest(
            where + self.center,
            normal.numpy().astype(np.float64),
            distance * np.sign(sign.numpy()),
        )
