"""The inner loops of `tsdf`, compiled by NVIDIA Warp.

Unit frame: n^3 cells tile the cube about the unit ball, and are given by their flat index.
"""

from typing import no_type_check  # compiled, not called: there is nothing to check

import warp as wp

from industnerf.geometry.warp_runtime import init_warp, mat34

init_warp()
wp.set_module_options({"enable_backward": False})

FADE_DEPTH = wp.constant(0.5)  # truncations behind a surface, from where on an image knows nothing


@wp.struct
@no_type_check
class DepthImages:
    """See `tsdf.DepthImages`."""

    depth: wp.array3d(dtype=wp.float32)
    nearest: wp.array3d(dtype=wp.float32)
    cosine: wp.array3d(dtype=wp.float32)
    projection: wp.array(dtype=mat34)


@wp.func
@no_type_check
def cell_center(cell: int, n: int):
    corner = wp.vec3(float(cell // (n * n)), float((cell // n) % n), float(cell % n))
    return (corner + wp.vec3(0.5, 0.5, 0.5)) * (2.0 / float(n)) - wp.vec3(1.0, 1.0, 1.0)


@wp.func_native("return fmaf(a, b, c);")
def fma(a: wp.float32, b: wp.float32, c: wp.float32) -> wp.float32: ...


@wp.func
@no_type_check
def matrix_row_product(matrix: mat34, row: int, x: wp.vec3):
    """Of the matrix times (x, 1), rounded as a product of matrices is."""
    first = fma(matrix[row, 1], x[1], matrix[row, 0] * x[0])
    return fma(matrix[row, 2], x[2], first) + matrix[row, 3]


@wp.func
@no_type_check
def project_to_pixel(images: DepthImages, view: int, x: wp.vec3):
    """Column, row and depth of a point; a depth of 0 if the view does not have it in frame."""
    u = matrix_row_product(images.projection[view], 0, x)
    v = matrix_row_product(images.projection[view], 1, x)
    depth = matrix_row_product(images.projection[view], 2, x)
    column = wp.int32(0)
    row = wp.int32(0)
    # before the division: beside the plane of the camera a quotient is more than an integer holds
    width = float(images.depth.shape[2])
    height = float(images.depth.shape[1])
    if depth > 0.0 and u >= 0.0 and v >= 0.0 and u < width * depth and v < height * depth:
        column = wp.min(int(u / depth), images.depth.shape[2] - 1)
        row = wp.min(int(v / depth), images.depth.shape[1] - 1)
    else:
        depth = 0.0
    return column, row, depth


@wp.kernel
@no_type_check
def measure_unseen(
    cells: wp.array(dtype=wp.int32),
    n: int,
    truncation: float,
    images: DepthImages,
    is_unseen: wp.array(dtype=wp.float32),
):
    """1 for cells that no image sees empty: in front of all that is about its pixel; else 0."""
    i = wp.tid()
    x = cell_center(cells[i], n)
    unseen = wp.float32(1.0)
    for view in range(images.depth.shape[0]):
        if unseen > 0.0:
            column, row, depth = project_to_pixel(images, view, x)
            if depth > 0.0 and images.nearest[view, row, column] - depth > truncation:
                unseen = 0.0
    is_unseen[i] = unseen


@wp.kernel
@no_type_check
def measure_mean(
    cells: wp.array(dtype=wp.int32),
    n: int,
    truncation: float,
    images: DepthImages,
    mean: wp.array(dtype=wp.float32),
):
    """Mean truncated signed distance from the tangent planes; `truncation` where none is known.

    Along a slanted ray a distance is longer; cut off outside and left out inside, such would draw
    the surface inwards.  The weight is the cosine between ray and normal, and fades to 0 behind
    what is seen: an image knows nothing of there, and would push out the far side of a thin wall.
    """
    i = wp.tid()
    x = cell_center(cells[i], n)
    total = wp.float32(0.0)
    weights = wp.float32(0.0)
    for view in range(images.depth.shape[0]):
        column, row, depth = project_to_pixel(images, view, x)
        if depth > 0.0:
            cosine = images.cosine[view, row, column]
            if cosine > 0.0:  # else there is no surface
                behind = (depth - images.depth[view, row, column]) * cosine
                fade = wp.clamp(2.0 - 2.0 * behind / (FADE_DEPTH * truncation), 0.0, 1.0)
                total += cosine * fade * wp.max(behind, -truncation)
                weights += cosine * fade
    mean[i] = truncation
    if weights > 0.0:
        mean[i] = total / weights
