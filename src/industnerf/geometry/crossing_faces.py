"""Faces of a mesh that others pass through, as bodies do that were never united.

Where two faces cross, a side of one of them pierces the other at either end of the crossing.  So
each side of each face is cast as a ray at the mesh, and all that it meets is looked at.
"""

from typing import no_type_check  # compiled, not called: nothing to check

import numpy as np
import warp as wp
from jaxtyping import Bool, Float32

from industnerf.geometry.embree_tree import RAY, EmbreeTree
from industnerf.geometry.warp_runtime import init_warp, on_cpu

init_warp()
wp.set_module_options({"enable_backward": False})

MARK_CROSSING = (
    RAY
    + """
    struct Side : Visitor {
        const float* corners;
        bool* is_crossing;
        unsigned face;
        const float *start, *end;
    };
    Side side;
    side.visit = [](Visitor& visitor, unsigned other) {
        const Side& side = (const Side&)visitor;
        for (int corner = 0; corner < 3; ++corner) {
            const float* point = side.corners + 9 * other + 3 * corner;
            bool is_start = true, is_end = true;
            for (int axis = 0; axis < 3; ++axis) {
                is_start &= point[axis] == side.start[axis];
                is_end &= point[axis] == side.end[axis];
            }
            if (is_start || is_end) return false;  // a neighbor
        }
        side.is_crossing[other] = side.is_crossing[side.face] = true;
        return false;
    };
    side.corners = corners.data;
    side.is_crossing = is_crossing.data;
    for (side.face = 0; side.face < faces; ++side.face) {
        for (int corner = 0; corner < 3; ++corner) {
            side.start = corners.data + 9 * side.face + 3 * corner;
            side.end = corners.data + 9 * side.face + 3 * ((corner + 1) % 3);
            float direction[3];
            for (int axis = 0; axis < 3; ++axis)
                direction[axis] = side.end[axis] - side.start[axis];
            visit_faces(intersect1, ray_of(side.start, direction, 1), side);
        }
    }
"""
)


@wp.func_native(MARK_CROSSING)
@no_type_check
def mark_crossing(
    intersect1: wp.uint64,
    scene: wp.uint64,
    corners: wp.array(dtype=wp.float32),
    faces: wp.uint32,
    is_crossing: wp.array(dtype=wp.bool),
): ...


@wp.kernel
@no_type_check
def mark_all_crossing(
    intersect1: wp.uint64,
    scene: wp.uint64,
    corners: wp.array(dtype=wp.float32),
    faces: wp.uint32,
    is_crossing: wp.array(dtype=wp.bool),
):
    """One thread."""
    mark_crossing(intersect1, scene, corners, faces, is_crossing)


def crossing_faces(
    tree: EmbreeTree, corners: Float32[np.ndarray, "m 3 3"]
) -> Bool[np.ndarray, "m"]:
    """Which faces of `tree`, whose corners are given, cross another or are touched by its side."""
    is_crossing = np.zeros(len(corners), bool)
    wp.launch(
        mark_all_crossing,
        1,
        [tree.intersect1, tree.scene, on_cpu(corners), len(corners)],
        [on_cpu(is_crossing)],
        device="cpu",
    )
    return is_crossing
