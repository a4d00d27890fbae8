"""Rays cast at a mesh one at a time, by embree."""

from typing import no_type_check  # compiled, not called: nothing to check

import numpy as np
import warp as wp
from jaxtyping import Bool, Float32, Int32

from industnerf.geometry.embree_tree import RAY, EmbreeTree
from industnerf.geometry.warp_runtime import init_warp, on_cpu

init_warp()
wp.set_module_options({"enable_backward": False, "fuse_fp": False})

CAST = (
    RAY
    + """
    const Search search =
        first_face(intersect1, corners.data, origins.data + 3 * i, directions.data + 3 * i);
    t.data[i] = (float)search.best.t;
    face.data[i] = search.face;
    uv.data[2 * i] = (float)search.best.u;
    uv.data[2 * i + 1] = (float)search.best.v;
"""
)
IS_OCCLUDED = (
    RAY
    + """
    Ray ray = ray_of(origins.data + 3 * i, directions.data + 3 * i, 1e37f);
    ((void (*)(void*, Ray*, void*))occluded1)(tree, &ray, nullptr);
    is_occluded.data[i] = ray.far < 0;  // embree sets -inf
"""
)


@wp.func_native(CAST)
@no_type_check
def cast_ray(
    i: wp.int32,
    intersect1: wp.uint64,
    scene: wp.uint64,
    corners: wp.array(dtype=wp.float32),
    origins: wp.array(dtype=wp.float32),
    directions: wp.array(dtype=wp.float32),
    t: wp.array(dtype=wp.float32),
    face: wp.array(dtype=wp.int32),
    uv: wp.array(dtype=wp.float32),
): ...


@wp.kernel
@no_type_check
def cast_rays(
    intersect1: wp.uint64,
    scene: wp.uint64,
    corners: wp.array(dtype=wp.float32),
    origins: wp.array(dtype=wp.float32),
    directions: wp.array(dtype=wp.float32),
    t: wp.array(dtype=wp.float32),
    face: wp.array(dtype=wp.int32),
    uv: wp.array(dtype=wp.float32),
):
    cast_ray(wp.tid(), intersect1, scene, corners, origins, directions, t, face, uv)


@wp.func_native(IS_OCCLUDED)
@no_type_check
def look_along_ray(
    i: wp.int32,
    occluded1: wp.uint64,
    scene: wp.uint64,
    origins: wp.array(dtype=wp.float32),
    directions: wp.array(dtype=wp.float32),
    is_occluded: wp.array(dtype=wp.bool),
): ...


@wp.kernel
@no_type_check
def look_along_rays(
    occluded1: wp.uint64,
    scene: wp.uint64,
    origins: wp.array(dtype=wp.float32),
    directions: wp.array(dtype=wp.float32),
    is_occluded: wp.array(dtype=wp.bool),
):
    look_along_ray(wp.tid(), occluded1, scene, origins, directions, is_occluded)


def cast_singly(
    tree: EmbreeTree,
    origins: Float32[np.ndarray, "rays 3"],
    directions: Float32[np.ndarray, "rays 3"],
) -> tuple[Float32[np.ndarray, "rays"], Int32[np.ndarray, "rays"], Float32[np.ndarray, "rays 2"]]:
    """t, face and uv of the first intersection of each ray; a ray that misses has face -1."""
    rays = len(directions)
    t, face, uv = np.empty(rays, np.float32), np.empty(rays, np.int32), np.empty((rays, 2), "f4")
    arrays = [on_cpu(x) for x in (tree.corners, origins, directions)]
    inputs = [tree.intersect1, tree.scene, *arrays]
    wp.launch(cast_rays, rays, inputs, [on_cpu(x) for x in (t, face, uv)], device="cpu")
    return t, face, uv


def are_occluded(
    tree: EmbreeTree,
    origins: Float32[np.ndarray, "rays 3"],
    directions: Float32[np.ndarray, "rays 3"],
) -> Bool[np.ndarray, "rays"]:
    """Whether each ray meets the mesh."""
    is_occluded = np.empty(len(directions), bool)
    inputs = [tree.occluded1, tree.scene, *(on_cpu(x) for x in (origins, directions))]
    wp.launch(look_along_rays, len(directions), inputs, [on_cpu(is_occluded)], device="cpu")
    return is_occluded
