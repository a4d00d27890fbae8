"""The inner loop, compiled: march the rays and composite; and back again.

One source for CPU and CUDA (NVIDIA Warp).  The loops are here; the equations stand in the files
that bear them, `compositing.py`, `confidence.py` and `sdf_density.py`, with the suffix `_wp`.

The adjoint is written by hand: Warp's automatic one is silently wrong for a transmittance that a
dynamic loop updates.  `torch_renderer.py` is what it is tested against.

Sample q of ray r has slot r * max_samples + q; its neighbors lie from k times that.
"""

from typing import no_type_check  # compiled, not called: there is nothing to check

import warp as wp

from industnerf.rendering.compositing import (
    MIN_OPACITY,
    median_depth_wp,
    opacity_wp,
    render_weight_wp,
    sample_transmittance_wp,
)
from industnerf.rendering.confidence import point_confidence_wp, reduce_sample_wp
from industnerf.rendering.neighbor_search_kernel import (
    CellGrid,
    NeighborBuffer,
    cell_at,
    find_neighbors,
)
from industnerf.rendering.sdf_density import density_derivative_wp, density_wp

OPACITY_FLOOR = wp.constant(MIN_OPACITY)

wp.set_module_options({"enable_backward": False, "fast_math": True})


@wp.struct
@no_type_check
class RayMarchParams:
    """Where rays are sampled, and when they end."""

    lo: wp.vec3
    hi: wp.vec3
    step: wp.float32
    early_stop_transmittance: wp.float32
    max_samples: wp.int32  # samples that a ray can have at most
    beta: wp.float32  # 0: points hold densities, else distances, and this is their softness
    median_beta: wp.float32  # the same, for the median alone


@wp.func
@no_type_check
def ray_box_intersection(origin: wp.vec3, direction: wp.vec3, lo: wp.vec3, hi: wp.vec3):
    """Where a ray enters and leaves the box, by slabs."""
    enter = wp.float32(0.0)
    leave = wp.float32(1.0e30)
    for axis in range(3):
        d = direction[axis]
        if d == 0.0:
            d = 1.0e-30
        a = (lo[axis] - origin[axis]) / d
        b = (hi[axis] - origin[axis]) / d
        enter = wp.max(enter, wp.min(a, b))
        leave = wp.min(leave, wp.max(a, b))
    return wp.vec2(enter, leave)


@wp.func
@no_type_check
def interpolate(
    neighbors: NeighborBuffer,
    first: wp.int32,
    size: wp.int32,
    values: wp.array(dtype=wp.float32),
    rgb: wp.array(dtype=wp.vec3),
):
    """What a sample's neighbors hold in the mean, by weight, and their color."""
    value = wp.float32(0.0)
    color = wp.vec3(0.0, 0.0, 0.0)
    for i in range(first, first + size):
        value += neighbors.weights[i] * values[neighbors.ids[i]]
        color += neighbors.weights[i] * rgb[neighbors.ids[i]]
    return value, color


@wp.kernel
@no_type_check
def forward(
    cells: CellGrid,
    params: RayMarchParams,
    values: wp.array(dtype=wp.float32),
    rgb: wp.array(dtype=wp.vec3),
    origins: wp.array(dtype=wp.vec3),
    directions: wp.array(dtype=wp.vec3),
    offsets: wp.array(dtype=wp.float32),
    neighbors: NeighborBuffer,
    color: wp.array(dtype=wp.vec3),
    transmittance: wp.array(dtype=wp.float32),
    depth: wp.array(dtype=wp.float32),
    median: wp.array(dtype=wp.float32),
):
    """Color before the background, T_end, mean distance, where T falls through 1/2.

    The last is of the surface that `median_beta` makes, or where that one never takes half of the
    light, of the other.  A ray goes on until both have ended.
    """
    r = wp.tid()
    t_range = ray_box_intersection(origins[r], directions[r], params.lo, params.hi)
    per_cell = cells.radius / params.step
    q = wp.int32(0)
    n = wp.int32(0)
    count = wp.int32(0)  # of the samples before T ends
    T = wp.float32(1.0)
    median_pending = params.median_beta != params.beta
    median_transmittance = wp.float32(1.0)  # T, with median_beta for beta
    c = wp.vec3(0.0, 0.0, 0.0)
    z = wp.float32(0.0)
    median_t = wp.float32(-1.0)
    fallback_t = wp.float32(-1.0)
    t = t_range[0] + offsets[r] * params.step
    while t < t_range[1] and n < params.max_samples:
        x = origins[r] + t * directions[r]
        cell = cell_at(cells, x)
        empty_cells = wp.int32(cells.distance_to_occupied[cell])
        if empty_cells > 0:  # the next away - 1 cells are empty too
            q += wp.max(1, wp.int32(wp.float32(empty_cells - 1) * per_cell))
        else:
            q += 1
            slot = r * params.max_samples + n
            size = find_neighbors(cells, x, cell, slot, neighbors)
            if size > 0:
                s, mean = interpolate(neighbors, slot * cells.k, size, values, rgb)
                neighbors.t[slot] = t
                n += 1
                if params.early_stop_transmittance <= T:
                    count = n
                    sigma = density_wp(params.beta, s)
                    transmitted = sample_transmittance_wp(sigma, params.step)
                    weight = render_weight_wp(T, opacity_wp(transmitted))
                    c += weight * mean
                    z += weight * t
                    fallback_t = median_depth_wp(fallback_t, T, sigma, t, params.step)
                    T = T * transmitted
                if median_pending:
                    sigma = density_wp(params.median_beta, s)
                    median_t = median_depth_wp(
                        median_t, median_transmittance, sigma, t, params.step
                    )
                    median_transmittance *= sample_transmittance_wp(sigma, params.step)
                    median_pending = (
                        median_t < 0.0 and params.early_stop_transmittance <= median_transmittance
                    )
                if params.early_stop_transmittance > T and not median_pending:
                    break
        t = t_range[0] + (wp.float32(q) + offsets[r]) * params.step
    neighbors.sample_counts[r] = count
    color[r] = c
    transmittance[r] = T
    depth[r] = z / wp.max(1.0 - T, OPACITY_FLOOR)
    if median_t < 0.0:
        median_t = fallback_t
    median[r] = median_t


@wp.kernel
@no_type_check
def backward(
    params: RayMarchParams,
    k: wp.int32,
    values: wp.array(dtype=wp.float32),
    rgb: wp.array(dtype=wp.vec3),
    neighbors: NeighborBuffer,
    color: wp.array(dtype=wp.vec3),
    transmittance: wp.array(dtype=wp.float32),
    depth: wp.array(dtype=wp.float32),
    d_color: wp.array(dtype=wp.vec3),
    d_transmittance: wp.array(dtype=wp.float32),
    d_depth: wp.array(dtype=wp.float32),
    d_values: wp.array(dtype=wp.float32),
    d_rgb: wp.array(dtype=wp.vec3),
):
    """The way back, from the eye again.

    With w_q = T_q alpha_q and v_q = dL/d w_q, what a sample adds to the loss by being seen,
        dL/d sigma_q = step (T_{q+1} v_q - sum_{p>q} w_p v_p - T_end dL/d T_end)
        dL/d c_q = w_q dL/d color
        v_q = c_q . dL/d color + (t_q - depth) / (1 - T_end) dL/d depth
    What lies behind a sample is the total less what lies before.  Of the depth the total is 0: it
    is the mean of t_q, weighted with w_q.
    """
    r = wp.tid()
    g = d_color[r]
    remaining = wp.dot(g, color[r])
    background_grad = d_transmittance[r] * transmittance[r]
    depth_grad = d_depth[r] / wp.max(1.0 - transmittance[r], OPACITY_FLOOR)
    T = wp.float32(1.0)
    for q in range(neighbors.sample_counts[r]):
        slot = r * params.max_samples + q
        first = slot * k
        s, mean = interpolate(neighbors, first, neighbors.neighbor_counts[slot], values, rgb)
        transmitted = sample_transmittance_wp(density_wp(params.beta, s), params.step)
        weight = render_weight_wp(T, opacity_wp(transmitted))
        T = T * transmitted
        weight_grad = wp.dot(g, mean) + depth_grad * (neighbors.t[slot] - depth[r])
        remaining -= weight * weight_grad
        ds = (
            density_derivative_wp(params.beta, s)
            * params.step
            * (T * weight_grad - remaining - background_grad)
        )
        for i in range(first, first + neighbors.neighbor_counts[slot]):
            wp.atomic_add(d_values, neighbors.ids[i], neighbors.weights[i] * ds)
            wp.atomic_add(d_rgb, neighbors.ids[i], (neighbors.weights[i] * weight) * g)


@wp.kernel
@no_type_check
def accumulate_confidence(
    params: RayMarchParams,
    k: wp.int32,
    values: wp.array(dtype=wp.float32),
    neighbors: NeighborBuffer,
    agreement: wp.array(dtype=wp.float32),
    own_transmittance: wp.bool,
    use_opacity: wp.bool,
    sum_samples: wp.bool,
    confidence: wp.array(dtype=wp.float32),
):
    """(13) of every neighbor j of every sample q of the rays, brought into `confidence`."""
    r = wp.tid()
    T = wp.float32(1.0)
    for q in range(neighbors.sample_counts[r]):
        first = (r * params.max_samples + q) * k
        last = first + neighbors.neighbor_counts[r * params.max_samples + q]
        s = wp.float32(0.0)
        max_weight = wp.float32(0.0)
        for i in range(first, last):
            s += neighbors.weights[i] * values[neighbors.ids[i]]
            max_weight = wp.max(max_weight, neighbors.weights[i])
        transmitted = sample_transmittance_wp(density_wp(params.beta, s), params.step)
        for i in range(first, last):
            value = point_confidence_wp(
                agreement[r],
                T,
                neighbors.weights[i],
                max_weight,
                transmitted,
                own_transmittance,
                use_opacity,
            )
            reduce_sample_wp(confidence, neighbors.ids[i], value, sum_samples)
        T = T * transmitted
