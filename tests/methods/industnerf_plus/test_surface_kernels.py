"""The compiled renderer of a shaded surface: closed forms, and its adjoint by differences."""

import numpy as np
import pytest
import warp as wp
from scipy.ndimage import gaussian_filter

from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.warp_launch import warp_device
from industnerf.methods.industnerf_plus import surface_kernels
from industnerf.methods.industnerf_plus.distance_grid import DistanceGrid
from industnerf.methods.industnerf_plus.finishes import FinishFit
from industnerf.methods.industnerf_plus.lighting import Lighting
from industnerf.methods.industnerf_plus.shaded_surface import (
    PinholeRays,
    ShadedSurface,
    launch,
    to_device,
)

SIZE, PX, DELTA = 28, 24, 0.05
NODES = np.stack(np.meshgrid(*[np.arange(float(SIZE))] * 3, indexing="ij"), axis=-1)
CELL = 2 / SIZE
LO = np.full(3, CELL / 2 - 1)
LIGHT = Lighting(0.25, np.array([[0.3, 0.2, -0.4], [-0.3, 0.1, -0.2]]))
VIEWS = Cameras(
    np.repeat(pinhole(30.0, PX)[None], 2, 0),
    look_at(np.array([[0, 0.5, -4.0], [3.0, -2.0, 2.0]]), np.zeros(3)),
    PX,
    PX,
)
PIXELS = np.arange(2 * PX * PX, dtype=np.int32)
WHITE = np.ones((2, 3))


def make_surface(distance: np.ndarray, albedo: np.ndarray | None = None) -> ShadedSurface:
    distance = distance.astype(np.float32)
    surface = ShadedSurface(DistanceGrid(distance, np.full_like(distance, -99), LO, CELL))
    surface.set_finishes(FinishFit(LIGHT, np.ones(1), np.zeros(0, np.int64), 0.0, 0.0))
    if albedo is not None:
        surface.set_node_albedo(albedo.astype(np.float32))
    inner = np.argwhere(np.ones((SIZE - 4,) * 3, bool)) + 2
    surface.update_gradient(to_device(inner, wp.vec3i))
    return surface


def ball(radius: float = 8.0) -> np.ndarray:
    return np.linalg.norm(NODES - (SIZE - 1) / 2, axis=-1) - radius


def rays_of(surface: ShadedSurface) -> PinholeRays:
    return PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid)


def test_a_hard_ball_has_the_depth_and_the_shading_of_a_ball():
    surface = make_surface(ball())
    rays = rays_of(surface)
    rendered = surface.render(rays, PIXELS, WHITE, 0.05, 0.1)
    hit, color = rendered.hit.numpy(), rendered.color.numpy()
    direction = rays.directions(PIXELS)
    origin = np.repeat(rays.centers, PX * PX, axis=0) - (SIZE - 1) / 2
    along = -(origin * direction).sum(axis=1)
    miss = np.linalg.norm(origin + along[:, None] * direction, axis=1)
    depth = along - np.sqrt(np.maximum(64 - miss**2, 0))
    is_inner, is_outer = miss < 7, miss > 8.5
    # trilinear between exact distances: chords of a curvature of 1 / 8 are off by 1 / 64 cells
    assert np.abs(hit - depth)[is_inner].max() < 0.1
    assert (hit[is_outer] == -1).all()
    normal = (origin + depth[:, None] * direction) / 8
    expected = LIGHT.brightness(normal)
    assert np.abs(color[is_inner] - expected[is_inner, None]).max() < 0.02
    np.testing.assert_allclose(color[is_outer], 1.0, atol=1e-4)
    np.testing.assert_allclose(rendered.opacity.numpy()[is_inner], 1, atol=0.01)


def test_albedo_multiplies_and_an_opaque_ray_tells_opacity():
    albedo = np.broadcast_to(np.array([0.5, 1.0, 0.25]), (*NODES.shape[:3], 3))
    plain, tinted = make_surface(ball()), make_surface(ball(), albedo)
    rays = rays_of(plain)
    black = np.zeros((2, 3))
    a, b = (s.render(rays, PIXELS, black, 0.3).color.numpy() for s in (plain, tinted))
    np.testing.assert_allclose(b, a * [0.5, 1.0, 0.25], atol=1e-5)
    opaque = tinted.render(rays, PIXELS, WHITE, 0.3, num_shaded=0)
    np.testing.assert_allclose(opaque.color.numpy()[:, 0], opaque.opacity.numpy(), atol=1e-5)


def loss_and_gradient(
    distance: np.ndarray,
    albedo: np.ndarray | None,
    target: np.ndarray,
    num_shaded: int,
    beta: float,
    step: float,
) -> tuple[float, np.ndarray]:
    """The sum of the Charbonnier loss over all pixels, and its gradient."""
    surface = make_surface(distance, albedo)
    rays, device = rays_of(surface), warp_device()
    rendered = surface.render(rays, PIXELS, WHITE, beta, step, num_shaded)
    shading = surface.shading(beta, step, num_shaded)
    shading.charbonnier = DELTA
    distance_grad = wp.zeros(distance.shape, wp.float32, device=device)
    gradient_grad = wp.zeros(distance.shape, wp.vec3, device=device)
    launch(
        surface_kernels.backpropagate,
        len(PIXELS),
        to_device(PIXELS, wp.int32),
        PX,
        PX,
        rays.device_pixel_to_ray,
        rays.device_centers,
        *surface.inputs(),
        shading,
        rendered.color,
        to_device(target),
        distance_grad,
        gradient_grad,
    )
    inner = to_device(np.argwhere(np.ones((SIZE - 4,) * 3, bool)) + 2, wp.vec3i)
    launch(
        surface_kernels.central_differences_adjoint,
        len(inner),
        inner,
        gradient_grad,
        distance_grad,
    )
    residual = rendered.color.numpy()[:, 0].astype(float) - target
    loss = (DELTA**2 * (np.sqrt(1 + (residual / DELTA) ** 2) - 1)).sum()
    return float(loss), distance_grad.numpy().astype(float)


@pytest.mark.parametrize("num_shaded", [len(PIXELS), 0], ids=["shaded", "opaque"])
@pytest.mark.parametrize("has_albedo", [False, True])
@pytest.mark.parametrize(("beta", "step"), [(0.6, 0.5), (0.5, 0.5), (0.3, 0.1)])
def test_the_adjoint_is_the_derivative(num_shaded, has_albedo, beta, step):
    """In random smooth directions, by central differences of a loss in float32.

    The derivative is a small difference of large terms.  Where sphere tracing ends depends on the
    distances, and the adjoint takes it as given.  That leaves 2 to 4 % of these terms, and 7 % of
    opaque rays, which have no others.  Without its part by normals, 16 % are off.  A surface harder
    than the step is sampled too coarsely for differences, so the last softness has finer steps.
    """
    rng = np.random.default_rng(0)
    albedo = 0.6 + 0.3 * rng.random((*NODES.shape[:3], 1)).repeat(3, 3) if has_albedo else None
    target = rng.random(len(PIXELS)).astype(np.float32)
    shape = ball() + 0.3 * np.sin(NODES[..., 0] / 3)
    _, gradient = loss_and_gradient(shape, albedo, target, num_shaded, beta, step)
    for _ in range(4):
        direction = np.zeros(shape.shape)
        direction[3:-3, 3:-3, 3:-3] = rng.standard_normal((SIZE - 6,) * 3)
        direction = gaussian_filter(direction, 2) + 0.02
        h = 0.02
        change = [
            loss_and_gradient(shape + s * h * direction, albedo, target, num_shaded, beta, step)[0]
            for s in (1, -1)
        ]
        numeric = (change[0] - change[1]) / (2 * h)
        analytic = float((gradient * direction).sum())
        scale = np.abs(gradient * direction).sum()
        assert abs(numeric - analytic) < (0.05 if num_shaded else 0.08) * scale
