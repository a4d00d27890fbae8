"""Rays cast at a mesh one at a time, by embree."""

from typing import no_type_check  # compiled, not called: nothing to check

import numpy as np
import warp as wp
from jaxtyping import Bool, Float32, Float64, Int32

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
    struct Block : Line {
        double within;
        bool is_met;
    };
    Block block;
    block.visit = [](Visitor& visitor, unsigned face) {
        Block& block = (Block&)visitor;
        return block.is_met = !(block.at(face).t >= block.within);
    };
    block.set(corners.data, origins.data + 3 * i, directions.data + 3 * i, meet);
    block.within = within.data[i];
    block.is_met = false;
    // Embree rounds its own t, by some 1e-6 of the mesh's size: it looks 1e-4 further than asked.
    double squared = 0;
    for (int axis = 0; axis < 3; ++axis)
        squared += (double)block.towards[axis] * block.towards[axis];
    const double far = block.within + 1e-4 / sqrt(squared);
    visit_faces(occluded1, ray_of(block.from, block.towards, (float)far), block);
    is_occluded.data[i] = block.is_met;
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
    corners: wp.array(dtype=wp.float32),
    origins: wp.array(dtype=wp.float32),
    directions: wp.array(dtype=wp.float32),
    within: wp.array(dtype=wp.float64),
    is_occluded: wp.array(dtype=wp.bool),
): ...


@wp.kernel
@no_type_check
def look_along_rays(
    occluded1: wp.uint64,
    scene: wp.uint64,
    corners: wp.array(dtype=wp.float32),
    origins: wp.array(dtype=wp.float32),
    directions: wp.array(dtype=wp.float32),
    within: wp.array(dtype=wp.float64),
    is_occluded: wp.array(dtype=wp.bool),
):
    look_along_ray(wp.tid(), occluded1, scene, corners, origins, directions, within, is_occluded)


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
    within: Float64[np.ndarray, "rays"],
) -> Bool[np.ndarray, "rays"]:
    """Whether each ray meets the mesh at a t below `within`."""
    is_occluded = np.empty(len(directions), bool)
    arrays = [on_cpu(x) for x in (tree.corners, origins, directions, within)]
    inputs = [tree.occluded1, tree.scene, *arrays]
    wp.launch(look_along_rays, len(directions), inputs, [on_cpu(is_occluded)], device="cpu")
    return is_occluded
