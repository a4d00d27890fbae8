"""Rendering of a signed-distance grid with shading, and its adjoint (NVIDIA Warp).

Opacity is that of "NeuS" -- Wang et al. (2021): with Phi the logistic function of softness beta,
a segment from signed distance s0 to s1 has

    a = max(0, 1 - Phi(s1) / Phi(s0)),

and shading is Lambert's, by the normal n of the distances at the middle of the segment:

    C = sum_i T_i a_i c_i + T_end * background,   T_i = prod_{j<i} (1 - a_j),
    c = albedo * (ambient + sum_k max(0, n . light_k)).

The adjoint is written by hand; it marches the same segments once more, with the light that is
left.  Positions and distances are in cells of the grid.
"""

from typing import Any, no_type_check  # compiled, not called: there is nothing to check

import warp as wp

from industnerf.geometry.warp_runtime import init_warp

init_warp()
wp.set_module_options({"enable_backward": False})

MIN_TRANSMITTANCE = wp.constant(0.005)  # at which a ray ends
MAX_OPACITY = wp.constant(0.9999)  # of a segment; the adjoint divides by what it lets through
OPAQUE_BETAS = 4.0
BAND_BETAS = wp.constant(OPAQUE_BETAS)  # a surface is opaque within so many betas of it
MIN_BAND = wp.constant(0.3)  # cells
MIN_SKIP = wp.constant(0.25)  # cells; shortest step through empty space
SKIP_SHARE = wp.constant(0.95)  # of the distance, which is not exact
BORDER = wp.constant(2.01)  # cells; normals need neighbors
MIN_GRADIENT = wp.constant(0.3)


@wp.struct
@no_type_check
class Shading:
    beta: wp.float32  # cells
    step: wp.float32  # cells
    ambient: wp.float32
    charbonnier: wp.float32  # residual from which the loss grows linearly
    has_albedo: wp.int32
    num_shaded: wp.int32  # the first rays; the others only tell that the part is there


@wp.struct
@no_type_check
class Segment:
    start: wp.float32
    end: wp.float32  # beyond the ray's end: there is no segment
    first: wp.float32  # signed distances at both ends
    last: wp.float32
    opacity: wp.float32


@wp.func
@no_type_check
def trilinear(values: wp.array3d(dtype=Any), x: wp.vec3):
    """Of numbers or of vectors, between the nodes about x."""
    i = int(x[0])
    j = int(x[1])
    k = int(x[2])
    a = x[0] - float(i)
    b = x[1] - float(j)
    c = x[2] - float(k)
    near_low = values[i, j]
    near_high = values[i, j + 1]
    far_low = values[i + 1, j]
    far_high = values[i + 1, j + 1]
    near = wp.lerp(
        wp.lerp(near_low[k], near_low[k + 1], c), wp.lerp(near_high[k], near_high[k + 1], c), b
    )
    far = wp.lerp(
        wp.lerp(far_low[k], far_low[k + 1], c), wp.lerp(far_high[k], far_high[k + 1], c), b
    )
    return wp.lerp(near, far, a)


@wp.func
@no_type_check
def splat(values: wp.array3d(dtype=wp.float32), x: wp.vec3, value: float):
    """The adjoint of `trilinear`."""
    i = int(x[0])
    j = int(x[1])
    k = int(x[2])
    a = x[0] - float(i)
    b = x[1] - float(j)
    c = x[2] - float(k)
    near = value * (1.0 - a)
    far = value * a
    wp.atomic_add(values, i, j, k, near * (1.0 - b) * (1.0 - c))
    wp.atomic_add(values, i, j, k + 1, near * (1.0 - b) * c)
    wp.atomic_add(values, i, j + 1, k, near * b * (1.0 - c))
    wp.atomic_add(values, i, j + 1, k + 1, near * b * c)
    wp.atomic_add(values, i + 1, j, k, far * (1.0 - b) * (1.0 - c))
    wp.atomic_add(values, i + 1, j, k + 1, far * (1.0 - b) * c)
    wp.atomic_add(values, i + 1, j + 1, k, far * b * (1.0 - c))
    wp.atomic_add(values, i + 1, j + 1, k + 1, far * b * c)


@wp.func
@no_type_check
def splat_vector(values: wp.array3d(dtype=wp.vec3), x: wp.vec3, value: wp.vec3):
    """The adjoint of `trilinear` of vectors."""
    i = int(x[0])
    j = int(x[1])
    k = int(x[2])
    a = x[0] - float(i)
    b = x[1] - float(j)
    c = x[2] - float(k)
    near = value * (1.0 - a)
    far = value * a
    wp.atomic_add(values, i, j, k, near * ((1.0 - b) * (1.0 - c)))
    wp.atomic_add(values, i, j, k + 1, near * ((1.0 - b) * c))
    wp.atomic_add(values, i, j + 1, k, near * (b * (1.0 - c)))
    wp.atomic_add(values, i, j + 1, k + 1, near * (b * c))
    wp.atomic_add(values, i + 1, j, k, far * ((1.0 - b) * (1.0 - c)))
    wp.atomic_add(values, i + 1, j, k + 1, far * ((1.0 - b) * c))
    wp.atomic_add(values, i + 1, j + 1, k, far * (b * (1.0 - c)))
    wp.atomic_add(values, i + 1, j + 1, k + 1, far * (b * c))


@wp.func
@no_type_check
def ray_direction(
    pixel: int, width: int, height: int, view: int, pixel_to_ray: wp.array(dtype=wp.mat33)
):
    """Of the center of a pixel, given by its flat index in all images."""
    in_view = pixel - view * width * height
    u = float(in_view % width) + 0.5
    v = float(in_view // width) + 0.5
    return wp.normalize(pixel_to_ray[view] * wp.vec3(u, v, 1.0))


@wp.func
@no_type_check
def clip_to_grid(origin: wp.vec3, direction: wp.vec3, distance: wp.array3d(dtype=wp.float32)):
    """Where a ray enters the grid and leaves it; it misses if that is before it enters."""
    enter = wp.float32(0.0)
    leave = wp.float32(1.0e9)
    for axis in range(3):
        d = direction[axis]
        if wp.abs(d) < 1.0e-9:
            d = 1.0e-9
        high = float(distance.shape[axis]) - 1.0 - BORDER
        a = (BORDER - origin[axis]) / d
        b = (high - origin[axis]) / d
        enter = wp.max(enter, wp.min(a, b))
        leave = wp.min(leave, wp.max(a, b))
    return wp.vec2(enter, leave)


@wp.func
@no_type_check
def logistic(x: float):
    if x < -20.0:
        return wp.exp(x)
    return 1.0 / (1.0 + wp.exp(-x))


@wp.func
@no_type_check
def next_segment(
    distance: wp.array3d(dtype=wp.float32),
    origin: wp.vec3,
    direction: wp.vec3,
    start: float,
    first: float,
    end_of_ray: float,
    shading: Shading,
):
    """The next segment that is near the surface; sphere tracing skips what is before it."""
    band = wp.max(BAND_BETAS * shading.beta, MIN_BAND)
    t = start
    s = first
    while s > band + MIN_SKIP and t < end_of_ray:
        t += SKIP_SHARE * wp.max(s - band, MIN_SKIP)
        if t < end_of_ray:
            s = trilinear(distance, origin + t * direction)
    segment = Segment()
    segment.start = t
    segment.end = t + shading.step
    segment.first = s
    segment.last = s
    if segment.end < end_of_ray:
        segment.last = trilinear(distance, origin + segment.end * direction)
    ratio = logistic(segment.last / shading.beta) / logistic(s / shading.beta)
    segment.opacity = wp.clamp(1.0 - ratio, 0.0, MAX_OPACITY)
    return segment


@wp.func
@no_type_check
def lambert(normal: wp.vec3, ambient: float, lights: wp.array(dtype=wp.vec3)):
    total = ambient
    for light in range(lights.shape[0]):
        total += wp.max(0.0, wp.dot(normal, lights[light]))
    return total


@wp.func
@no_type_check
def lambert_gradient(normal: wp.vec3, lights: wp.array(dtype=wp.vec3)):
    total = wp.vec3(0.0, 0.0, 0.0)
    for light in range(lights.shape[0]):
        if wp.dot(normal, lights[light]) > 0.0:
            total += lights[light]
    return total


@wp.kernel
@no_type_check
def render(
    pixels: wp.array(dtype=wp.int32),
    width: int,
    height: int,
    pixel_to_ray: wp.array(dtype=wp.mat33),
    centers: wp.array(dtype=wp.vec3),
    background: wp.array(dtype=wp.vec3),
    distance: wp.array3d(dtype=wp.float32),
    gradient: wp.array3d(dtype=wp.vec3),
    albedo: wp.array3d(dtype=wp.vec3),
    lights: wp.array(dtype=wp.vec3),
    shading: Shading,
    color: wp.array(dtype=wp.vec3),
    opacity: wp.array(dtype=wp.float32),
    hit: wp.array(dtype=wp.float32),
):
    """Color and opacity of each pixel, and where (cells) half of the light of its ray is left.

    That is -1 where more of it passes the surface.
    """
    ray = wp.tid()
    view = pixels[ray] // (width * height)
    direction = ray_direction(pixels[ray], width, height, view, pixel_to_ray)
    origin = centers[view]
    span = clip_to_grid(origin, direction, distance)
    total = wp.vec3(0.0, 0.0, 0.0)
    transmittance = wp.float32(1.0)
    found = wp.float32(-1.0)
    if span[0] < span[1]:
        t = span[0]
        s = trilinear(distance, origin + t * direction)
        while transmittance > MIN_TRANSMITTANCE and t < span[1]:
            segment = next_segment(distance, origin, direction, t, s, span[1], shading)
            if segment.end < span[1] and segment.opacity > 0.0:
                middle = 0.5 * (segment.start + segment.end)
                value = wp.vec3(1.0, 1.0, 1.0)
                if ray < shading.num_shaded:
                    x = origin + middle * direction
                    if shading.has_albedo != 0:
                        value = trilinear(albedo, x)
                    normal = wp.normalize(trilinear(gradient, x))
                    value *= lambert(normal, shading.ambient, lights)
                total += transmittance * segment.opacity * value
                before = transmittance
                transmittance *= 1.0 - segment.opacity
                if before > 0.5 and transmittance <= 0.5:
                    found = middle
            t = segment.end
            s = segment.last
    if ray < shading.num_shaded:
        total += transmittance * background[view]
    color[ray] = total
    opacity[ray] = 1.0 - transmittance
    hit[ray] = found


@wp.kernel
@no_type_check
def backpropagate(
    pixels: wp.array(dtype=wp.int32),
    width: int,
    height: int,
    pixel_to_ray: wp.array(dtype=wp.mat33),
    centers: wp.array(dtype=wp.vec3),
    distance: wp.array3d(dtype=wp.float32),
    gradient: wp.array3d(dtype=wp.vec3),
    albedo: wp.array3d(dtype=wp.vec3),
    lights: wp.array(dtype=wp.vec3),
    shading: Shading,
    color: wp.array(dtype=wp.vec3),
    target: wp.array(dtype=wp.float32),
    distance_grad: wp.array3d(dtype=wp.float32),
    gradient_grad: wp.array3d(dtype=wp.vec3),
):
    """Add each pixel's gradient of the Charbonnier loss.

    Pictures are gray: of colors the first channel counts.
    """
    ray = wp.tid()
    view = pixels[ray] // (width * height)
    direction = ray_direction(pixels[ray], width, height, view, pixel_to_ray)
    origin = centers[view]
    span = clip_to_grid(origin, direction, distance)
    residual = color[ray][0] - target[ray]
    scaled = residual / shading.charbonnier
    color_grad = residual / wp.sqrt(1.0 + scaled * scaled)
    is_shaded = ray < shading.num_shaded
    if span[0] < span[1]:
        behind = color[ray][0]  # the color of what is behind the segments so far
        transmittance = wp.float32(1.0)
        t = span[0]
        s = trilinear(distance, origin + t * direction)
        while transmittance > MIN_TRANSMITTANCE and t < span[1]:
            segment = next_segment(distance, origin, direction, t, s, span[1], shading)
            if segment.end < span[1] and segment.opacity > 0.0:
                x = origin + 0.5 * (segment.start + segment.end) * direction
                slope = trilinear(gradient, x)
                normal = wp.normalize(slope)
                light = wp.float32(1.0)
                reflectance = wp.float32(1.0)
                if is_shaded:
                    light = lambert(normal, shading.ambient, lights)
                    if shading.has_albedo != 0:
                        reflectance = trilinear(albedo, x)[0]
                weight = transmittance * segment.opacity
                behind -= weight * light * reflectance
                # dC/da = T c - (light from behind) / (1 - a)
                opacity_grad = color_grad * (
                    transmittance * light * reflectance - behind / (1.0 - segment.opacity)
                )
                phi0 = logistic(segment.first / shading.beta)
                phi1 = logistic(segment.last / shading.beta)
                scale = opacity_grad * phi1 / (phi0 * shading.beta)
                if segment.opacity < MAX_OPACITY:
                    splat(distance_grad, origin + segment.start * direction, scale * (1.0 - phi0))
                    splat(distance_grad, origin + segment.end * direction, -scale * (1.0 - phi1))
                if is_shaded:
                    value_grad = color_grad * weight
                    # d(n . l) / d slope = (l - n (n . l)) / |slope|
                    towards = lambert_gradient(normal, lights)
                    towards -= normal * wp.dot(normal, towards)
                    factor = value_grad * reflectance / wp.max(wp.length(slope), MIN_GRADIENT)
                    splat_vector(gradient_grad, x, towards * factor)
                transmittance *= 1.0 - segment.opacity
            t = segment.end
            s = segment.last


@wp.kernel
@no_type_check
def central_differences(
    nodes: wp.array(dtype=wp.vec3i),
    distance: wp.array3d(dtype=wp.float32),
    gradient: wp.array3d(dtype=wp.vec3),
):
    node = nodes[wp.tid()]
    i = node[0]
    j = node[1]
    k = node[2]
    gradient[i, j, k] = 0.5 * wp.vec3(
        distance[i + 1, j, k] - distance[i - 1, j, k],
        distance[i, j + 1, k] - distance[i, j - 1, k],
        distance[i, j, k + 1] - distance[i, j, k - 1],
    )


@wp.kernel
@no_type_check
def central_differences_adjoint(
    nodes: wp.array(dtype=wp.vec3i),
    gradient_grad: wp.array3d(dtype=wp.vec3),
    distance_grad: wp.array3d(dtype=wp.float32),
):
    """Move the gradient to the distances, and clear it."""
    node = nodes[wp.tid()]
    i = node[0]
    j = node[1]
    k = node[2]
    half = 0.5 * gradient_grad[i, j, k]
    gradient_grad[i, j, k] = wp.vec3(0.0, 0.0, 0.0)
    wp.atomic_add(distance_grad, i + 1, j, k, half[0])
    wp.atomic_add(distance_grad, i - 1, j, k, -half[0])
    wp.atomic_add(distance_grad, i, j + 1, k, half[1])
    wp.atomic_add(distance_grad, i, j - 1, k, -half[1])
    wp.atomic_add(distance_grad, i, j, k + 1, half[2])
    wp.atomic_add(distance_grad, i, j, k - 1, -half[2])
