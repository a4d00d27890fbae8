"""The neighbors of a radiance point and their weights, compiled: section 3.3, reading R7.

The search is half of a ray's cost, so it is written in the C++ that Warp compiles for CPU and
CUDA alike.  `neighbors.py` and `weights.py` are the same in torch.
"""

from typing import no_type_check  # compiled, not called: there is nothing to check

import warp as wp

from industnerf.geometry.warp_runtime import init_warp
from industnerf.rendering.weights import FLOOR

init_warp()


@wp.struct
@no_type_check
class CellGrid:
    """Points sorted by the cell they are in; cells are as wide as the radius.

    The last index varies fastest, so that three neighboring cells are one run of points.
    """

    points: wp.array(dtype=wp.vec3)
    first: wp.array(dtype=wp.int32)  # point of each cell, and one beyond the last
    # in cells, to the nearest cell that has an occupied point within the radius
    distance_to_occupied: wp.array(dtype=wp.uint8)
    corner: wp.vec3
    nx: wp.int32
    ny: wp.int32
    nz: wp.int32
    radius: wp.float32
    k: wp.int32
    reading: wp.int32  # 0 inverse, 1 inverse_square, 2 modified_shepard, 3 trilinear
    is_grid_aligned: wp.bool  # trilinear, and each point is alone in the middle of its cell


@wp.struct
@no_type_check
class NeighborBuffer:
    """The neighbors of each ray's samples; a sample has one slot here, and k of neighbors."""

    sample_counts: wp.array(dtype=wp.int32)  # of a ray: samples with a neighbor, until it ends
    t: wp.array(dtype=wp.float32)  # of a sample: its distance along the ray
    neighbor_counts: wp.array(dtype=wp.int32)  # of a sample
    ids: wp.array(dtype=wp.int32)
    weights: wp.array(dtype=wp.float32)


SEARCH = """
    const wp::vec3* p = points.data;
    int* id = ids.data + slot * k;
    float* w = weights.data + slot * k;
    float reach = radius * radius;
    int count = 0, worst = 0;
    int begin[9], end[9];
    for (int row = 0; row < 9; ++row) {
        const int middle = cell + ((row / 3 - 1) * ny + row % 3 - 1) * nz;
        begin[row] = first.data[middle - 1];
        end[row] = first.data[middle + 2];
    }
#ifndef __CUDA_ARCH__  // fetch all rows at once instead of waiting for memory at each
    for (int row = 0; row < 9; ++row) {
        __builtin_prefetch(p + begin[row]);
        __builtin_prefetch(p + begin[row] + 5);  // in the next cache line
    }
#endif
    for (int row = 0; row < 9; ++row)
        for (int j = begin[row]; j < end[row]; ++j) {
            const float dx = p[j][0] - x[0], dy = p[j][1] - x[1], dz = p[j][2] - x[2];
            const float square = reading == 3
                ? wp::max(wp::max(dx * dx, dy * dy), dz * dz)  // trilinear weights reach a cube
                : dx * dx + dy * dy + dz * dz;
            if (count == k && square >= reach) continue;
            id[worst] = j;
            w[worst] = square;
            // a point too far is overwritten by the next: cheaper than a branch at random
            if (count < k) worst = count += square < reach;
            if (count < k) continue;
            worst = 0;  // full: from now on only what is nearer than the farthest
            for (int i = 1; i < k; ++i)
                if (w[i] > w[worst]) worst = i;
            reach = w[worst];
        }
    float total = 0.0f;
    for (int i = 0; i < count; ++i) {
        if (reading == 3) {
            const wp::vec3& q = p[id[i]];
            w[i] = (1.0f - wp::abs(q[0] - x[0]) / radius) * (1.0f - wp::abs(q[1] - x[1]) / radius)
                * (1.0f - wp::abs(q[2] - x[2]) / radius);
            total += w[i];
            continue;
        }
        const float distance = wp::sqrt(w[i]);
        const float bounded = wp::max(distance, FLOOR * radius);
        float v = (reading == 2 ? 1.0f - distance / radius : 1.0f) / bounded;
        if (reading) v *= v;
        w[i] = v;
        total += v;
    }
    if (!(total > 0.0f)) count = 0;  // all are so far off that they weigh nothing
    for (int i = 0; i < count; ++i) w[i] /= total;
    sizes.data[slot] = count;
""".replace("FLOOR", f"{FLOOR}f")


@wp.func_native(SEARCH)
@no_type_check
def search(
    points: wp.array(dtype=wp.vec3),
    first: wp.array(dtype=wp.int32),
    ny: wp.int32,
    nz: wp.int32,
    radius: wp.float32,
    k: wp.int32,
    reading: wp.int32,
    x: wp.vec3,
    cell: wp.int32,
    slot: wp.int32,
    sizes: wp.array(dtype=wp.int32),
    ids: wp.array(dtype=wp.int32),
    weights: wp.array(dtype=wp.float32),
): ...


CORNERS = """
    int* id = ids.data + slot * k;
    float* w = weights.data + slot * k;
    float total = 0.0f;
    int count = 0;
    for (int row = 0; row < 4; ++row) {
        const int* at = first.data + lowest + ((row >> 1) * ny + (row & 1)) * nz;
        const float share = (row >> 1 ? place[0] : 1.0f - place[0])
            * (row & 1 ? place[1] : 1.0f - place[1]);
        const float own[2] = {share * (1.0f - place[2]), share * place[2]};
        for (int i = 0; i < 2; ++i) {
            const bool there = at[i] < at[i + 1] && own[i] > 0.0f;
            id[count] = at[i];
            w[count] = own[i];
            total += there ? own[i] : 0.0f;
            count += there;  // what is not there is overwritten by the next
        }
    }
    for (int i = 0; i < count; ++i) w[i] /= total;
    sizes.data[slot] = count;
"""


@wp.func_native(CORNERS)
@no_type_check
def grid_corners(
    first: wp.array(dtype=wp.int32),
    ny: wp.int32,
    nz: wp.int32,
    k: wp.int32,
    lowest: wp.int32,
    place: wp.vec3,
    slot: wp.int32,
    sizes: wp.array(dtype=wp.int32),
    ids: wp.array(dtype=wp.int32),
    weights: wp.array(dtype=wp.float32),
): ...


@wp.func
@no_type_check
def find_neighbors(
    cells: CellGrid, x: wp.vec3, cell: wp.int32, slot: wp.int32, neighbors: NeighborBuffer
):
    """Write the neighbors of `x` in `cell` into `slot`, weights of sum 1; returns their number."""
    if cells.is_grid_aligned:  # they are the corners of a cube: 8 cells to look into, not 27
        p = (x - cells.corner) / cells.radius - wp.vec3(0.5, 0.5, 0.5)
        ix = wp.clamp(wp.int32(p[0]), 0, cells.nx - 2)
        iy = wp.clamp(wp.int32(p[1]), 0, cells.ny - 2)
        iz = wp.clamp(wp.int32(p[2]), 0, cells.nz - 2)
        grid_corners(
            cells.first,
            cells.ny,
            cells.nz,
            cells.k,
            (ix * cells.ny + iy) * cells.nz + iz,
            p - wp.vec3(wp.float32(ix), wp.float32(iy), wp.float32(iz)),
            slot,
            neighbors.neighbor_counts,
            neighbors.ids,
            neighbors.weights,
        )
    else:
        search(
            cells.points,
            cells.first,
            cells.ny,
            cells.nz,
            cells.radius,
            cells.k,
            cells.reading,
            x,
            cell,
            slot,
            neighbors.neighbor_counts,
            neighbors.ids,
            neighbors.weights,
        )
    return neighbors.neighbor_counts[slot]


@wp.func
@no_type_check
def cell_at(cells: CellGrid, x: wp.vec3):
    """The flat index of the cell of `x`; of the nearest cell where `x` is outside."""
    p = (x - cells.corner) / cells.radius
    ix = wp.clamp(wp.int32(p[0]), 1, cells.nx - 2)
    iy = wp.clamp(wp.int32(p[1]), 1, cells.ny - 2)
    iz = wp.clamp(wp.int32(p[2]), 1, cells.nz - 2)
    return (ix * cells.ny + iy) * cells.nz + iz


@wp.kernel
@no_type_check
def mark_occupied(
    points: wp.array(dtype=wp.vec3), cells: CellGrid, occupied: wp.array(dtype=wp.uint8)
):
    """Mark the cells of which some position is within the radius of a point."""
    p = (points[wp.tid()] - cells.corner) / cells.radius
    for a in range(-1, 2):
        for b in range(-1, 2):
            for c in range(-1, 2):
                i = wp.int32(p[0]) + a
                j = wp.int32(p[1]) + b
                k = wp.int32(p[2]) + c
                closest = wp.vec3(
                    wp.clamp(p[0], wp.float32(i), wp.float32(i + 1)),
                    wp.clamp(p[1], wp.float32(j), wp.float32(j + 1)),
                    wp.clamp(p[2], wp.float32(k), wp.float32(k + 1)),
                )
                # generous: a cell too many costs little; trilinear weights reach all 27
                if cells.reading == 3 or wp.length(closest - p) <= 1.001:
                    occupied[(i * cells.ny + j) * cells.nz + k] = wp.uint8(1)
