"""Exact distances of points to the triangles of a surface."""

from typing import no_type_check  # compiled, not called: there is nothing to check

import numpy as np
import warp as wp
from jaxtyping import Float, Int

from industnerf.geometry.warp_runtime import init_warp

init_warp()
wp.set_module_options({"enable_backward": False})


@wp.kernel
@no_type_check
def _distances(
    mesh: wp.uint64,
    points: wp.array(dtype=wp.vec3),
    max_distance: wp.float32,
    distances: wp.array(dtype=wp.float32),
):
    i = wp.tid()
    query = wp.mesh_query_point_no_sign(mesh, points[i], max_distance)
    distances[i] = wp.length(points[i] - wp.mesh_eval_position(mesh, query.face, query.u, query.v))


def distance_to_surface(
    points: Float[np.ndarray, "n 3"],
    vertices: Float[np.ndarray, "v 3"],
    faces: Int[np.ndarray, "f 3"],
) -> Float[np.ndarray, "n"]:
    """Distance of each point to the nearest point of the surface, in the unit of both.

    Computed in float32 about the surface's center: off by some 1e-6 of what lies between.
    """
    center = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    centered_points, corners = ((x - center).astype(np.float32) for x in (points, vertices))
    # the search is bounded by more than any distance can be
    max_distance = 2 * (
        1
        + np.linalg.norm(centered_points, axis=1).max(initial=0)
        + np.linalg.norm(corners, axis=1).max()
    )
    device = wp.get_device("cpu")
    mesh = wp.Mesh(
        wp.array(corners, dtype=wp.vec3, device=device),
        wp.array(faces.astype(np.int32).ravel(), dtype=wp.int32, device=device),
    )
    queries = wp.array(centered_points, dtype=wp.vec3, device=device)
    distances = wp.empty(len(points), dtype=wp.float32, device=device)
    wp.launch(_distances, len(points), [mesh.id, queries, max_distance, distances], device=device)
    return distances.numpy().astype(np.float64)
