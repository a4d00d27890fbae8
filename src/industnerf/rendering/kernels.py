"""The inner loop, compiled: march the rays and composite; and back again.

One source for CPU and CUDA (NVIDIA Warp).  The adjoint is written by hand: Warp's automatic one
is silently wrong for a transmittance that a dynamic loop updates.  `twin.py` is the slow oracle.

Sample q of ray r has slot r * room + q; its neighbors lie from k times that.
"""

from typing import no_type_check  # compiled, not called: there is nothing to check

import warp as wp

from industnerf.rendering.compositing import MIN_OPACITY
from industnerf.rendering.neighbor_search_kernel import (
    CellGrid,
    NeighborBuffer,
    cell_at,
    find_neighbors,
)
from industnerf.rendering.sdf_density import SIGMOID_CUTOFF

CUTOFF = wp.constant(SIGMOID_CUTOFF)
OPACITY_FLOOR = wp.constant(MIN_OPACITY)
EXPONENT_LIMIT = wp.constant(50.0)

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
def sigmoid(beta: wp.float32, value: wp.float32):
    """The logistic function of -value / beta; kept from overflow, which fast maths forbids."""
    return 1.0 / (1.0 + wp.exp(wp.min(value / beta, EXPONENT_LIMIT)))


@wp.func
@no_type_check
def density(beta: wp.float32, value: wp.float32):
    """`distance.density` of what a sample's neighbors hold in the mean."""
    if beta == 0.0:
        return value
    return wp.max(sigmoid(beta, value) - CUTOFF, 0.0) / beta


@wp.func
@no_type_check
def density_derivative(beta: wp.float32, value: wp.float32):
    """How much the density grows with the value."""
    if beta == 0.0:
        return wp.float32(1.0)
    inside_share = sigmoid(beta, value)
    if inside_share <= CUTOFF:
        return wp.float32(0.0)
    return -inside_share * (1.0 - inside_share) / (beta * beta)


@wp.func
@no_type_check
def median_depth(
    median: wp.float32, T: wp.float32, tau: wp.float32, t: wp.float32, step: wp.float32
):
    """Where T falls through 1/2: `found` before, or in the sample of depth `tau` round `t`; -1."""
    if median < 0.0 and T * wp.exp(-tau) < 0.5:
        return t + (wp.log(2.0 * T) / tau - 0.5) * step
    return median


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
                    tau = density(params.beta, s) * params.step
                    transmitted = wp.exp(-tau)
                    weight = T * (1.0 - transmitted)
                    c += weight * mean
                    z += weight * t
                    fallback_t = median_depth(fallback_t, T, tau, t, params.step)
                    T = T * transmitted
                if median_pending:
                    tau = density(params.median_beta, s) * params.step
                    median_t = median_depth(median_t, median_transmittance, tau, t, params.step)
                    median_transmittance = median_transmittance * wp.exp(-tau)
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
        transmitted = wp.exp(-density(params.beta, s) * params.step)
        weight = T * (1.0 - transmitted)
        T = T * transmitted
        weight_grad = wp.dot(g, mean) + depth_grad * (neighbors.t[slot] - depth[r])
        remaining -= weight * weight_grad
        ds = (
            density_derivative(params.beta, s)
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
    """(13): S T_q W_qj / max_j W_qj of every neighbor j of every sample q; R9, R15, R16."""
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
        transmitted = wp.exp(-density(params.beta, s) * params.step)
        value = agreement[r] * T / max_weight
        if own_transmittance:
            value = value * transmitted
        if use_opacity:
            value = value * (1.0 - transmitted)
        T = T * transmitted
        for i in range(first, last):
            if sum_samples:
                wp.atomic_add(confidence, neighbors.ids[i], value * neighbors.weights[i])
            else:
                wp.atomic_max(confidence, neighbors.ids[i], value * neighbors.weights[i])
