"""The inner loop, compiled: march the rays and composite; and back again.

One source for CPU and CUDA (NVIDIA Warp).  The adjoint is written by hand: Warp's automatic one
is silently wrong for a transmittance that a dynamic loop updates.  `twin.py` is the slow oracle.

Sample q of ray r has slot r * room + q; its neighbours lie from k times that.
"""

from typing import no_type_check  # compiled, not called: there is nothing to check

import warp as wp

from industnerf.rendering.compositing import FAINTEST
from industnerf.rendering.distance import FAINT
from industnerf.rendering.nearest import Cells, Met, cell_at, nearest

NOTHING = wp.constant(FAINT)
LEAST = wp.constant(FAINTEST)
FAR = wp.constant(50.0)

wp.set_module_options({"enable_backward": False, "fast_math": True})


@wp.struct
@no_type_check
class March:
    """Where rays are sampled, and when they end."""

    lo: wp.vec3
    hi: wp.vec3
    step: wp.float32
    stop: wp.float32
    room: wp.int32  # samples that a ray can have at most
    beta: wp.float32  # 0: points hold densities, else distances, and this is their softness
    median_beta: wp.float32  # the same, for the median alone


@wp.func
@no_type_check
def crossing(origin: wp.vec3, direction: wp.vec3, lo: wp.vec3, hi: wp.vec3):
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
def inside(beta: wp.float32, value: wp.float32):
    """The logistic function of -value / beta; kept from overflow, which fast maths forbids."""
    return 1.0 / (1.0 + wp.exp(wp.min(value / beta, FAR)))


@wp.func
@no_type_check
def density(beta: wp.float32, value: wp.float32):
    """`distance.density` of what a sample's neighbours hold in the mean."""
    if beta == 0.0:
        return value
    return wp.max(inside(beta, value) - NOTHING, 0.0) / beta


@wp.func
@no_type_check
def slope(beta: wp.float32, value: wp.float32):
    """How much the density grows with the value."""
    if beta == 0.0:
        return wp.float32(1.0)
    share = inside(beta, value)
    if share <= NOTHING:
        return wp.float32(0.0)
    return -share * (1.0 - share) / (beta * beta)


@wp.func
@no_type_check
def halfway(found: wp.float32, T: wp.float32, tau: wp.float32, t: wp.float32, step: wp.float32):
    """Where T falls through 1/2: `found` before, or in the sample of depth `tau` round `t`; -1."""
    if found < 0.0 and T * wp.exp(-tau) < 0.5:
        return t + (wp.log(2.0 * T) / tau - 0.5) * step
    return found


@wp.func
@no_type_check
def mean_of(
    met: Met,
    first: wp.int32,
    size: wp.int32,
    values: wp.array(dtype=wp.float32),
    rgb: wp.array(dtype=wp.vec3),
):
    """What a sample's neighbours hold in the mean, by weight, and their colour."""
    value = wp.float32(0.0)
    colour = wp.vec3(0.0, 0.0, 0.0)
    for i in range(first, first + size):
        value += met.weights[i] * values[met.ids[i]]
        colour += met.weights[i] * rgb[met.ids[i]]
    return value, colour


@wp.kernel
@no_type_check
def forward(
    cells: Cells,
    march: March,
    values: wp.array(dtype=wp.float32),
    rgb: wp.array(dtype=wp.vec3),
    origins: wp.array(dtype=wp.vec3),
    directions: wp.array(dtype=wp.vec3),
    offsets: wp.array(dtype=wp.float32),
    met: Met,
    colour: wp.array(dtype=wp.vec3),
    through: wp.array(dtype=wp.float32),
    depth: wp.array(dtype=wp.float32),
    median: wp.array(dtype=wp.float32),
):
    """Colour before the background, T_end, mean distance, where T falls through 1/2.

    The last is of the surface that `median_beta` makes, or where that one never takes half of the
    light, of the other.  A ray goes on until both have ended.
    """
    r = wp.tid()
    span = crossing(origins[r], directions[r], march.lo, march.hi)
    per_cell = cells.radius / march.step
    q = wp.int32(0)
    n = wp.int32(0)
    count = wp.int32(0)  # of the samples before T ends
    T = wp.float32(1.0)
    watching = march.median_beta != march.beta
    left = wp.float32(1.0)  # T, with median_beta for beta
    c = wp.vec3(0.0, 0.0, 0.0)
    z = wp.float32(0.0)
    middle = wp.float32(-1.0)
    fallback = wp.float32(-1.0)
    t = span[0] + offsets[r] * march.step
    while t < span[1] and n < march.room:
        x = origins[r] + t * directions[r]
        cell = cell_at(cells, x)
        away = wp.int32(cells.away[cell])
        if away > 0:  # the next away - 1 cells are empty too
            q += wp.max(1, wp.int32(wp.float32(away - 1) * per_cell))
        else:
            q += 1
            slot = r * march.room + n
            size = nearest(cells, x, cell, slot, met)
            if size > 0:
                s, mean = mean_of(met, slot * cells.k, size, values, rgb)
                met.at[slot] = t
                n += 1
                if march.stop <= T:
                    count = n
                    tau = density(march.beta, s) * march.step
                    kept = wp.exp(-tau)
                    share = T * (1.0 - kept)
                    c += share * mean
                    z += share * t
                    fallback = halfway(fallback, T, tau, t, march.step)
                    T = T * kept
                if watching:
                    tau = density(march.median_beta, s) * march.step
                    middle = halfway(middle, left, tau, t, march.step)
                    left = left * wp.exp(-tau)
                    watching = middle < 0.0 and march.stop <= left
                if march.stop > T and not watching:
                    break
        t = span[0] + (wp.float32(q) + offsets[r]) * march.step
    met.count[r] = count
    colour[r] = c
    through[r] = T
    depth[r] = z / wp.max(1.0 - T, LEAST)
    if middle < 0.0:
        middle = fallback
    median[r] = middle


@wp.kernel
@no_type_check
def backward(
    march: March,
    k: wp.int32,
    values: wp.array(dtype=wp.float32),
    rgb: wp.array(dtype=wp.vec3),
    met: Met,
    colour: wp.array(dtype=wp.vec3),
    through: wp.array(dtype=wp.float32),
    depth: wp.array(dtype=wp.float32),
    d_colour: wp.array(dtype=wp.vec3),
    d_through: wp.array(dtype=wp.float32),
    d_depth: wp.array(dtype=wp.float32),
    d_values: wp.array(dtype=wp.float32),
    d_rgb: wp.array(dtype=wp.vec3),
):
    """The way back, from the eye again.

    With w_q = T_q alpha_q and v_q = dL/d w_q, what a sample adds to the loss by being seen,
        dL/d sigma_q = step (T_{q+1} v_q - sum_{p>q} w_p v_p - T_end dL/d T_end)
        dL/d c_q = w_q dL/d colour
        v_q = c_q . dL/d colour + (t_q - depth) / (1 - T_end) dL/d depth
    What lies behind a sample is the total less what lies before.  Of the depth the total is 0: it
    is the mean of t_q, weighted with w_q.
    """
    r = wp.tid()
    g = d_colour[r]
    behind = wp.dot(g, colour[r])
    ending = d_through[r] * through[r]
    deeper = d_depth[r] / wp.max(1.0 - through[r], LEAST)
    T = wp.float32(1.0)
    for q in range(met.count[r]):
        slot = r * march.room + q
        first = slot * k
        s, mean = mean_of(met, first, met.sizes[slot], values, rgb)
        kept = wp.exp(-density(march.beta, s) * march.step)
        share = T * (1.0 - kept)
        T = T * kept
        here = wp.dot(g, mean) + deeper * (met.at[slot] - depth[r])
        behind -= share * here
        ds = slope(march.beta, s) * march.step * (T * here - behind - ending)
        for i in range(first, first + met.sizes[slot]):
            wp.atomic_add(d_values, met.ids[i], met.weights[i] * ds)
            wp.atomic_add(d_rgb, met.ids[i], (met.weights[i] * share) * g)


@wp.kernel
@no_type_check
def confide(
    march: March,
    k: wp.int32,
    values: wp.array(dtype=wp.float32),
    met: Met,
    agreement: wp.array(dtype=wp.float32),
    own: wp.bool,
    opaque: wp.bool,
    adding: wp.bool,
    confidence: wp.array(dtype=wp.float32),
):
    """(13): S T_q W_qj / max_j W_qj of every neighbour j of every sample q; R9, R15, R16."""
    r = wp.tid()
    T = wp.float32(1.0)
    for q in range(met.count[r]):
        first = (r * march.room + q) * k
        last = first + met.sizes[r * march.room + q]
        s = wp.float32(0.0)
        most = wp.float32(0.0)
        for i in range(first, last):
            s += met.weights[i] * values[met.ids[i]]
            most = wp.max(most, met.weights[i])
        kept = wp.exp(-density(march.beta, s) * march.step)
        value = agreement[r] * T / most
        if own:
            value = value * kept
        if opaque:
            value = value * (1.0 - kept)
        T = T * kept
        for i in range(first, last):
            if adding:
                wp.atomic_add(confidence, met.ids[i], value * met.weights[i])
            else:
                wp.atomic_max(confidence, met.ids[i], value * met.weights[i])
