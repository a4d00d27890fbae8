"""The inner loops over the nodes of a distance grid (NVIDIA Warp): distances, smoothing, steps."""

from typing import no_type_check  # compiled, not called: there is nothing to check

import warp as wp

from industnerf.geometry.warp_runtime import init_warp

init_warp()
wp.set_module_options({"enable_backward": False})

FAR = wp.constant(1.0e6)
MAX_CURVATURE = wp.constant(1.0)


@wp.func
@no_type_check
def upwind_slope(inside: float, before: float, after: float):
    """Of the steeper way to the other side."""
    if inside > 0.0:
        return wp.max(0.0, inside - wp.min(before, after))
    return wp.max(0.0, wp.max(before, after) - inside)


@wp.kernel
@no_type_check
def start_near_zero(
    values: wp.array3d(dtype=wp.float32),
    distance: wp.array3d(dtype=wp.float32),
    is_fixed: wp.array3d(dtype=wp.uint8),
):
    """Distances of the nodes within a cell of the zero set, by their slope.

    At a right-angled crease central differences have half of the slope there is on either side,
    upwind ones twice as much; their geometric mean is exact, there and on planes.
    """
    i, j, k = wp.tid()
    s = values[i, j, k]
    distance[i, j, k] = FAR
    is_fixed[i, j, k] = wp.uint8(0)
    left = values[wp.max(i - 1, 0), j, k]
    right = values[wp.min(i + 1, values.shape[0] - 1), j, k]
    front = values[i, wp.max(j - 1, 0), k]
    back = values[i, wp.min(j + 1, values.shape[1] - 1), k]
    below = values[i, j, wp.max(k - 1, 0)]
    above = values[i, j, wp.min(k + 1, values.shape[2] - 1)]
    central = 0.5 * wp.length(wp.vec3(right - left, back - front, above - below))
    upwind = wp.length(
        wp.vec3(
            upwind_slope(s, left, right),
            upwind_slope(s, front, back),
            upwind_slope(s, below, above),
        )
    )
    slope = wp.sqrt(central * upwind)
    if wp.abs(s) < slope:
        distance[i, j, k] = wp.abs(s) / slope
        is_fixed[i, j, k] = wp.uint8(1)


@wp.kernel
@no_type_check
def sweep(
    distance: wp.array3d(dtype=wp.float32),
    is_fixed: wp.array3d(dtype=wp.uint8),
    reverse: wp.vec3i,
    width: float,
    num_changed: wp.array(dtype=wp.int32),
):
    """One sweep of |grad d| = 1 -- Zhao, "A fast sweeping method for Eikonal equations" (2005).

    A thread takes one row of nodes.  A CPU takes the rows one after the other, so each node sees
    the new values before it; a GPU needs more sweeps to the same values.
    """
    i, j = wp.tid()
    n0 = distance.shape[0]
    n1 = distance.shape[1]
    n2 = distance.shape[2]
    k = wp.int32(0)
    step = wp.int32(1)
    if reverse[0] != 0:
        i = n0 - 1 - i
    if reverse[1] != 0:
        j = n1 - 1 - j
    if reverse[2] != 0:
        k = n2 - 1
        step = wp.int32(-1)
    # the rows about it; beyond the border, where there is none, itself, which brings nothing nearer
    row = distance[i, j]
    left = distance[wp.max(i - 1, 0), j]
    right = distance[wp.min(i + 1, n0 - 1), j]
    front = distance[i, wp.max(j - 1, 0)]
    back = distance[i, wp.min(j + 1, n1 - 1)]
    row_is_fixed = is_fixed[i, j]
    before = wp.float32(FAR)
    current = row[k]
    for n in range(n2):
        after = wp.float32(FAR)
        if n < n2 - 1:
            after = row[k + step]
        if row_is_fixed[k] == wp.uint8(0):
            a = wp.min(left[k], right[k])
            b = wp.min(front[k], back[k])
            c = wp.min(before, after)
            low = wp.min(a, wp.min(b, c))
            if low < current and low <= width:
                high = wp.max(a, wp.max(b, c))
                middle = wp.max(wp.min(a, b), wp.min(wp.max(a, b), c))
                x = low + 1.0
                if x > middle:
                    gap = low - middle
                    x = 0.5 * (low + middle + wp.sqrt(wp.max(2.0 - gap * gap, 0.0)))
                    if x > high:
                        total = low + middle + high
                        square = low * low + middle * middle + high * high
                        root = total * total - 3.0 * (square - 1.0)
                        if root > 0.0:
                            x = (total + wp.sqrt(root)) / 3.0
                if x < current:
                    if current - x > 1.0e-4:
                        wp.atomic_add(num_changed, 0, 1)
                    row[k] = x
                    current = x
        before = current
        current = after
        k += step


@wp.kernel
@no_type_check
def gather(
    nodes: wp.array(dtype=wp.vec3i),
    values: wp.array3d(dtype=wp.float32),
    column: wp.array(dtype=wp.float32),
):
    """`values` at the nodes."""
    i = wp.tid()
    column[i] = values[nodes[i][0], nodes[i][1], nodes[i][2]]


@wp.kernel
@no_type_check
def smooth(
    neighbors: wp.array2d(dtype=wp.int32),
    column: wp.array(dtype=wp.float32),
    smoothed: wp.array(dtype=wp.float32),
):
    """Mean of each node and those of its six neighbors that are in the band."""
    i = wp.tid()
    total = column[i]
    count = wp.float32(1.0)
    for n in range(6):
        neighbor = neighbors[i, n]
        if neighbor >= 0:
            total += column[neighbor]
            count += 1.0
    smoothed[i] = total / count


@wp.struct
@no_type_check
class StepParams:
    lr: wp.float32  # cells
    epsilon: wp.float32
    momentum: wp.float32
    momentum_correction: wp.float32
    decay: wp.float32
    decay_correction: wp.float32
    max_step: wp.float32  # cells
    curvature: wp.float32
    relax_rate: wp.float32  # share of what was carved that comes back


@wp.kernel
@no_type_check
def step_distances(
    nodes: wp.array(dtype=wp.vec3i),
    distance: wp.array3d(dtype=wp.float32),
    hull: wp.array3d(dtype=wp.float32),
    start: wp.array3d(dtype=wp.float32),
    grad: wp.array(dtype=wp.float32),
    first_moment: wp.array3d(dtype=wp.float32),
    second_moment: wp.array3d(dtype=wp.float32),
    params: StepParams,
    stepped: wp.array(dtype=wp.float32),
):
    """A step of Adam and of curvature flow, never out of the hull; what was carved comes back."""
    n = wp.tid()
    i = nodes[n][0]
    j = nodes[n][1]
    k = nodes[n][2]
    m = params.momentum * first_moment[i, j, k] + (1.0 - params.momentum) * grad[n]
    v = params.decay * second_moment[i, j, k] + (1.0 - params.decay) * grad[n] * grad[n]
    first_moment[i, j, k] = m
    second_moment[i, j, k] = v
    s = distance[i, j, k]
    laplacian = (
        distance[i + 1, j, k]
        + distance[i - 1, j, k]
        + distance[i, j + 1, k]
        + distance[i, j - 1, k]
        + distance[i, j, k + 1]
        + distance[i, j, k - 1]
        - 6.0 * s
    )
    change = -params.lr * (m / params.momentum_correction)
    change /= wp.sqrt(v / params.decay_correction) + params.epsilon
    change += params.curvature * wp.clamp(laplacian, -MAX_CURVATURE, MAX_CURVATURE)
    change += params.relax_rate * wp.min(start[i, j, k] - s, 0.0)
    s += wp.clamp(change, -params.max_step, params.max_step)
    stepped[n] = wp.max(s, hull[i, j, k])


@wp.kernel
@no_type_check
def scatter(
    nodes: wp.array(dtype=wp.vec3i),
    column: wp.array(dtype=wp.float32),
    values: wp.array3d(dtype=wp.float32),
):
    """Set `values` at the nodes."""
    i = wp.tid()
    values[nodes[i][0], nodes[i][1], nodes[i][2]] = column[i]


@wp.kernel
@no_type_check
def mark_passed(
    origins: wp.array(dtype=wp.vec3),
    directions: wp.array(dtype=wp.vec3),
    ends: wp.array(dtype=wp.float32),
    step: float,
    hull: wp.array3d(dtype=wp.float32),
    is_passed: wp.array3d(dtype=wp.uint8),
):
    """Mark the nodes in the hull that rays pass before they end."""
    n = wp.tid()
    t = ends[n] - step
    while t > 0.0:
        p = origins[n] + t * directions[n]
        i = int(wp.round(p[0]))
        j = int(wp.round(p[1]))
        k = int(wp.round(p[2]))
        if i < 0 or j < 0 or k < 0:
            break
        if i >= hull.shape[0] or j >= hull.shape[1] or k >= hull.shape[2]:
            break
        if hull[i, j, k] < 0.0:
            is_passed[i, j, k] = wp.uint8(1)
        t -= step
