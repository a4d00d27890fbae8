"""How far points are from a surface: from its triangles, not from samples of them."""

from typing import no_type_check  # compiled, not called: there is nothing to check

import numpy as np
import warp as wp
from jaxtyping import Float, Int

from industnerf.geometry.compiled import start

start()
wp.set_module_options({"enable_backward": False})


@wp.kernel
@no_type_check
def _distances(
    mesh: wp.uint64,
    points: wp.array(dtype=wp.vec3),
    farthest: wp.float32,
    found: wp.array(dtype=wp.float32),
):
    i = wp.tid()
    query = wp.mesh_query_point_no_sign(mesh, points[i], farthest)
    found[i] = wp.length(points[i] - wp.mesh_eval_position(mesh, query.face, query.u, query.v))


def distance_to_surface(
    points: Float[np.ndarray, "n 3"],
    vertices: Float[np.ndarray, "v 3"],
    faces: Int[np.ndarray, "f 3"],
) -> Float[np.ndarray, "n"]:
    """Distance of each point to the nearest point of the surface, in the unit of both.

    Computed in float32 about the surface's centre: off by some 1e-6 of what lies between.
    """
    centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    about, corners = ((x - centre).astype(np.float32) for x in (points, vertices))
    # the search is bounded by more than any distance can be
    farthest = 2 * (
        1 + np.linalg.norm(about, axis=1).max(initial=0) + np.linalg.norm(corners, axis=1).max()
    )
    where = wp.get_device("cpu")
    mesh = wp.Mesh(
        wp.array(corners, dtype=wp.vec3, device=where),
        wp.array(faces.astype(np.int32).ravel(), dtype=wp.int32, device=where),
    )
    asked = wp.array(about, dtype=wp.vec3, device=where)
    found = wp.empty(len(points), dtype=wp.float32, device=where)
    wp.launch(_distances, len(points), [mesh.id, asked, farthest, found], device=where)
    return found.numpy().astype(np.float64)
