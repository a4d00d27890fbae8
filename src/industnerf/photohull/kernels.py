"""The inner loops, compiled (NVIDIA Warp): depth of cells in the hull, and their color gaps.

Unit frame: the region of interest is the ball of radius 1 about the origin, and n^3 cells tile
the cube around it.  Cells are given by their flat index.
"""

from typing import no_type_check  # compiled, not called: there is nothing to check

import warp as wp

from industnerf.geometry.warp_runtime import init_warp, mat34
from industnerf.photohull import voxel_grid

init_warp()
wp.set_module_options({"enable_backward": False})

OCCLUSION_START = wp.constant(2.0)  # cells; what is nearer to a cell does not hide it
UNKNOWN = wp.constant(float(voxel_grid.UNKNOWN))
OUTSIDE = wp.constant(3.0)  # cells; beyond it how far a cell is outside does not matter
NORMAL_RADIUS = wp.constant(2)  # cells on either side that a normal is taken from
MAX_OUTLIER_VIEWS = wp.constant(3)  # views that may disagree: `insert_descending` keeps one more


@wp.func
@no_type_check
def unravel_index(cell: int, n: int):
    return wp.vec3i(cell // (n * n), (cell // n) % n, cell % n)


@wp.func
@no_type_check
def cell_center(index: wp.vec3i, spacing: float):
    corner = wp.vec3(float(index[0]), float(index[1]), float(index[2]))
    return (corner + wp.vec3(0.5, 0.5, 0.5)) * spacing - wp.vec3(1.0, 1.0, 1.0)


@wp.func
@no_type_check
def project_point(matrix: mat34, x: wp.vec3):
    """u, v (px) and depth."""
    image = matrix * wp.vec4(x[0], x[1], x[2], 1.0)
    return wp.vec3(image[0] / image[2], image[1] / image[2], image[2])


@wp.func
@no_type_check
def bilinear(images: wp.array3d(dtype=wp.float32), view: int, u: float, v: float):
    """Between the pixels' centers; outside its frame an image goes on as it ends."""
    x = wp.clamp(u - 0.5, 0.0, float(images.shape[2]) - 1.001)
    y = wp.clamp(v - 0.5, 0.0, float(images.shape[1]) - 1.001)
    left = int(x)
    top = int(y)
    a = x - float(left)
    b = y - float(top)
    upper = images[view, top]
    lower = images[view, top + 1]
    return wp.lerp(
        wp.lerp(upper[left], upper[left + 1], a), wp.lerp(lower[left], lower[left + 1], a), b
    )


@wp.kernel
@no_type_check
def measure_depth(
    cells: wp.array(dtype=wp.int32),
    n: int,
    distance: wp.array3d(dtype=wp.float32),
    projection: wp.array(dtype=mat34),
    focal: wp.array(dtype=wp.float32),
    depth: wp.array(dtype=wp.float32),
):
    """Depth of each cell's center in all silhouettes, in cells; beyond OUTSIDE only its sign."""
    i = wp.tid()
    spacing = 2.0 / float(n)
    x = cell_center(unravel_index(cells[i], n), spacing)
    min_depth = wp.float32(1.0e6)
    for view in range(projection.shape[0]):
        if min_depth > -OUTSIDE:
            pixel = project_point(projection[view], x)
            if pixel[2] > 0.0:
                inside = bilinear(distance, view, pixel[0], pixel[1])
                min_depth = wp.min(min_depth, inside * pixel[2] / (focal[view] * spacing))
    depth[i] = min_depth


@wp.func
@no_type_check
def is_solid(solid: wp.array3d(dtype=wp.uint8), i: int, j: int, k: int):
    n = solid.shape[0]
    if i < 0 or j < 0 or k < 0 or i >= n or j >= n or k >= n:
        return False
    return solid[i, j, k] != wp.uint8(0)


@wp.func
@no_type_check
def normal_at(solid: wp.array3d(dtype=wp.uint8), cell: wp.vec3i):
    """Unit vector away from the centroid of the solid cells about this one."""
    outward = wp.vec3(0.0, 0.0, 0.0)
    for di in range(-NORMAL_RADIUS, NORMAL_RADIUS + 1):
        for dj in range(-NORMAL_RADIUS, NORMAL_RADIUS + 1):
            for dk in range(-NORMAL_RADIUS, NORMAL_RADIUS + 1):
                if is_solid(solid, cell[0] + di, cell[1] + dj, cell[2] + dk):
                    outward -= wp.vec3(float(di), float(dj), float(dk))
    return wp.normalize(outward)


@wp.func
@no_type_check
def is_occluded(
    solid: wp.array3d(dtype=wp.uint8),
    start: wp.vec3,
    direction: wp.vec3,
    start_cells: float,
    spacing: float,
    lo: wp.vec3,
    hi: wp.vec3,
):
    """Whether a ray meets a solid cell, from `start_cells` after its start to the box's end."""
    t = start_cells * spacing
    occluded = wp.bool(False)
    x = start + t * direction
    while (
        not occluded
        and x[0] > lo[0]
        and x[1] > lo[1]
        and x[2] > lo[2]
        and x[0] < hi[0]
        and x[1] < hi[1]
        and x[2] < hi[2]
    ):
        occluded = is_solid(
            solid,
            int((x[0] + 1.0) / spacing),
            int((x[1] + 1.0) / spacing),
            int((x[2] + 1.0) / spacing),
        )
        t += spacing
        x = start + t * direction
    return occluded


@wp.func
@no_type_check
def insert_descending(largest: wp.vec4, x: float):
    """The four largest, in descending order."""
    a = wp.max(largest[0], x)
    x = wp.min(largest[0], x)
    b = wp.max(largest[1], x)
    x = wp.min(largest[1], x)
    c = wp.max(largest[2], x)
    x = wp.min(largest[2], x)
    return wp.vec4(a, b, c, wp.max(largest[3], x))


@wp.struct
@no_type_check
class CarvingParams:
    lo: wp.vec3
    hi: wp.vec3
    min_facing_cosine: wp.float32
    outlier_share: wp.float32
    min_views: wp.int32


@wp.kernel
@no_type_check
def measure_color_gap(
    cells: wp.array(dtype=wp.int32),
    solid: wp.array3d(dtype=wp.uint8),
    darkest: wp.array4d(dtype=wp.uint8),
    brightest: wp.array4d(dtype=wp.uint8),
    projection: wp.array(dtype=mat34),
    camera_centers: wp.array(dtype=wp.vec3),
    params: CarvingParams,
    gap: wp.array(dtype=wp.float32),
):
    """By how much no color lies in the ranges of all views; UNKNOWN of fewer than `min_views`."""
    i = wp.tid()
    spacing = 2.0 / float(solid.shape[0])
    index = unravel_index(cells[i], solid.shape[0])
    x = cell_center(index, spacing)
    normal = normal_at(solid, index)
    none = wp.vec4(0.0, 0.0, 0.0, 0.0)
    r0 = none
    g0 = none
    b0 = none
    r1 = none
    g1 = none
    b1 = none
    count = wp.int32(0)
    for view in range(projection.shape[0]):
        view_direction = wp.normalize(camera_centers[view] - x)
        if wp.dot(view_direction, normal) > params.min_facing_cosine:
            pixel = project_point(projection[view], x)
            u = int(wp.floor(pixel[0]))
            v = int(wp.floor(pixel[1]))
            in_frame = pixel[2] > 0.0 and u >= 0 and v >= 0
            in_frame = in_frame and u < darkest.shape[2] and v < darkest.shape[1]
            occluded = is_occluded(
                solid, x, view_direction, OCCLUSION_START, spacing, params.lo, params.hi
            )
            if in_frame and not occluded:
                count += 1
                r0 = insert_descending(r0, float(darkest[view, v, u, 0]))
                g0 = insert_descending(g0, float(darkest[view, v, u, 1]))
                b0 = insert_descending(b0, float(darkest[view, v, u, 2]))
                r1 = insert_descending(r1, 255.0 - float(brightest[view, v, u, 0]))
                g1 = insert_descending(g1, 255.0 - float(brightest[view, v, u, 1]))
                b1 = insert_descending(b1, 255.0 - float(brightest[view, v, u, 2]))
    dropped_views = wp.min(int(params.outlier_share * float(count)), MAX_OUTLIER_VIEWS)
    if count < params.min_views:
        gap[i] = UNKNOWN
    else:
        worst = wp.max(
            r0[dropped_views] + r1[dropped_views],
            wp.max(g0[dropped_views] + g1[dropped_views], b0[dropped_views] + b1[dropped_views]),
        )
        gap[i] = worst / 255.0 - 1.0


@wp.kernel
@no_type_check
def smooth_color_gap(
    cells: wp.array(dtype=wp.int32),
    solid: wp.array3d(dtype=wp.uint8),
    gap: wp.array3d(dtype=wp.float32),
    max_gap: wp.float32,
    mean: wp.array(dtype=wp.float32),
):
    """The mean gap of the 27 solid cells about each cell whose own gap is above 0.

    A gap counts up to `max_gap`: one very inconsistent cell takes no other with it.
    """
    i = wp.tid()
    index = unravel_index(cells[i], solid.shape[0])
    total = wp.float32(0.0)
    count = wp.float32(0.0)
    for di in range(-1, 2):
        for dj in range(-1, 2):
            for dk in range(-1, 2):
                a = index[0] + di
                b = index[1] + dj
                d = index[2] + dk
                if is_solid(solid, a, b, d):
                    value = gap[a, b, d]
                    if value > UNKNOWN:
                        total += wp.clamp(value, -max_gap, max_gap)
                        count += 1.0
    mean[i] = UNKNOWN
    if gap[index[0], index[1], index[2]] > 0.0:
        mean[i] = total / count
