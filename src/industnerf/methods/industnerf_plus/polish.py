"""Polishing: move the surface until it looks, under the fitted light, as the pictures show it.

Shading tells the normal of every pixel, where color consistency needs texture.  Distances stay
inside the visual hull.  What is carved comes back a little at every step, for a plane looks alike
wherever it is; what is filled stays.  Pixels whose brightness is not to be trusted still show
that the part is there.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
import warp as wp

from industnerf.geometry.warp_launch import warp_device
from industnerf.methods.industnerf_plus import grid_kernels, surface_kernels
from industnerf.methods.industnerf_plus.distance_grid import (
    band_nodes,
    node_neighbors,
)
from industnerf.methods.industnerf_plus.pictures import EDGE_SHARE, Pictures
from industnerf.methods.industnerf_plus.shaded_surface import (
    PinholeRays,
    ShadedSurface,
    launch,
    to_device,
)
from industnerf.schema.industnerf import PolishSettings

SILHOUETTE_MARGIN = 1.1  # cells; nearer to an outline the soft surface mixes in what is behind
LIGHT_MARGIN = 1.6  # cells
LIGHT_BETA = 0.3  # cells
CHARBONNIER = 0.05  # residual from which the loss grows linearly
MOMENTUM, DECAY = 0.9, 0.98  # of Adam
MAX_STEP = 0.25  # cells
BAND = (3.0, 2.5)  # betas and cells on either side of the surface that move
NODES_INTERVAL = 5  # steps between updates of these nodes ...
REDISTANCE_INTERVAL = 20  # ... and of exact distances
GRADIENT_SMOOTHINGS = 2
MIN_LIGHT_PIXELS = 500
MAX_TESTED_PIXELS = 40_000  # for whether the surface covers them
MIN_COVERED_OPACITY = 0.8


class Polisher:
    """Takes the steps; the surface of `surface` moves."""

    def __init__(
        self,
        surface: ShadedSurface,
        rays: PinholeRays,
        pictures: Pictures,
        cell_px: float,
        settings: PolishSettings,
        seed: int,
    ) -> None:
        self._surface, self._rays, self._pictures = surface, rays, pictures
        self._settings = settings
        self._rng = np.random.default_rng(seed)
        self._hull = to_device(surface.grid.hull)
        self._start = to_device(surface.grid.distance)
        shape, device = surface.grid.hull.shape, warp_device()
        self._distance_grad = wp.zeros(shape, wp.float32, device=device)
        self._gradient_grad = wp.zeros(shape, wp.vec3, device=device)
        self._moments = [wp.zeros(shape, wp.float32, device=device) for _ in range(2)]
        margin = SILHOUETTE_MARGIN * cell_px
        self._shaded = pictures.shaded_pixels(margin, EDGE_SHARE, self._rng)
        self._uncovered = self._opaque = pictures.opaque_pixels(margin)
        self._light_pixels = pictures.shaded_pixels(LIGHT_MARGIN * cell_px, 0.0, self._rng)

    def fit_light(self) -> bool:
        """Fit light and finishes to the surface as it is; False where no pixel can be trusted."""
        if not len(self._light_pixels):
            return False
        pixels = self._rng.choice(self._light_pixels, self._settings.light_pixels)
        self._surface.update_band(LIGHT_BETA)
        hit = self._surface.render(
            self._rays, pixels, self._pictures.gray_background, LIGHT_BETA
        ).hit.numpy()
        pixels, hit = pixels[hit > 0], hit[hit > 0]
        if len(pixels) < MIN_LIGHT_PIXELS:
            return False
        rgb = self._pictures.rgb[pixels] / 255
        self._surface.fit_light(self._rays.points(pixels, hit), rgb)
        return True

    def steps(self) -> Iterator[float]:
        """Take all steps; yields the mean squared error of the pixels of each."""
        settings = self._settings
        for step in range(settings.steps):
            progress = step / max(1, settings.steps - 1)
            beta = interpolate(settings.beta.start, settings.beta.end, progress)
            lr = interpolate(settings.lr.start, settings.lr.end, progress)
            if step and step % REDISTANCE_INTERVAL == 0:
                self._surface.redistance()
            if step and settings.light_interval and step % settings.light_interval == 0:
                self.fit_light()
            if step % REDISTANCE_INTERVAL == 0:
                self._find_uncovered(beta)
            if step % NODES_INTERVAL == 0:
                band = Band(self._surface.distance.numpy(), BAND[0] * beta + BAND[1])
            self._surface.update_gradient(band.nodes)
            error = self._backpropagate(beta)
            launch(
                surface_kernels.central_differences_adjoint,
                len(band.nodes),
                band.nodes,
                self._gradient_grad,
                self._distance_grad,
            )
            gradient = band.smoothed(self._distance_grad, GRADIENT_SMOOTHINGS)
            self._distance_grad.zero_()
            self._move(band, gradient, lr, step)
            yield error
        self._surface.redistance()

    def _find_uncovered(self, beta: float) -> None:
        """Of the pixels that show the part, those that the surface does not cover."""
        if not len(self._opaque):
            return
        pixels = self._rng.choice(self._opaque, MAX_TESTED_PIXELS)
        self._surface.update_band(beta)
        background = self._pictures.gray_background
        opacity = self._surface.render(self._rays, pixels, background, beta).opacity.numpy()
        uncovered = pixels[opacity < MIN_COVERED_OPACITY]
        self._uncovered = uncovered if len(uncovered) else self._opaque

    def _backpropagate(self, beta: float) -> float:
        """Add the gradient of some random pixels; returns their mean squared error."""
        settings, pictures, surface = self._settings, self._pictures, self._surface
        num_opaque = (
            int(settings.opaque_fraction * settings.rays_per_step) if len(self._opaque) else 0
        )
        num_shaded = settings.rays_per_step - num_opaque
        shaded = self._shaded[self._rng.integers(0, len(self._shaded), num_shaded)]
        opaque = self._uncovered[self._rng.integers(0, max(1, len(self._uncovered)), num_opaque)]
        pixels = np.concatenate([shaded, opaque])
        target = np.concatenate([pictures.gray[shaded], np.ones(num_opaque, np.float32)])
        step = settings.step_size * max(1.0, beta)
        rendered = surface.render(
            self._rays, pixels, pictures.gray_background, beta, step, num_shaded
        )
        shading = surface.shading(beta, step, num_shaded)
        shading.charbonnier = CHARBONNIER
        launch(
            surface_kernels.backpropagate,
            len(pixels),
            to_device(pixels, wp.int32),
            self._rays.width,
            self._rays.height,
            self._rays.device_pixel_to_ray,
            self._rays.device_centers,
            *surface.inputs(),
            shading,
            rendered.color,
            to_device(target),
            self._distance_grad,
            self._gradient_grad,
        )
        residual = rendered.color.numpy()[:num_shaded, 0] - target[:num_shaded]
        return float(np.mean(residual.astype(np.float64) ** 2))

    def _move(self, band: "Band", gradient: Any, lr: float, step: int) -> None:
        values = gradient.numpy().astype(np.float64)
        params = grid_kernels.StepParams()
        params.lr = lr
        params.epsilon = float(np.sqrt(np.mean(values**2))) + 1e-12
        params.momentum, params.decay = MOMENTUM, DECAY
        params.momentum_correction = 1 - MOMENTUM ** (step + 1)
        params.decay_correction = 1 - DECAY ** (step + 1)
        params.max_step, params.curvature = MAX_STEP, self._settings.curvature_rate
        params.relax_rate = self._settings.relax_rate
        moved = wp.empty(len(band.nodes), wp.float32, device=warp_device())
        launch(
            grid_kernels.step_distances,
            len(band.nodes),
            band.nodes,
            self._surface.distance,
            self._hull,
            self._start,
            gradient,
            *self._moments,
            params,
            moved,
        )
        launch(grid_kernels.scatter, len(band.nodes), band.nodes, moved, self._surface.distance)


class Band:
    """The nodes near the surface, and their neighbors."""

    def __init__(self, distance: np.ndarray, width: float) -> None:
        nodes = band_nodes(distance, width)
        self.nodes = to_device(nodes, wp.vec3i)
        self._neighbors = to_device(node_neighbors(nodes, distance.shape), wp.int32)
        self._columns = [wp.empty(len(nodes), wp.float32, device=warp_device()) for _ in range(2)]

    def smoothed(self, values: Any, times: int) -> Any:
        """`values` at the nodes, averaged over neighbors so many times."""
        launch(grid_kernels.gather, len(self.nodes), self.nodes, values, self._columns[0])
        for number in range(times):
            source, target = self._columns[number % 2], self._columns[1 - number % 2]
            launch(grid_kernels.smooth, len(self.nodes), self._neighbors, source, target)
        return self._columns[times % 2]


def interpolate(start: float, end: float, progress: float) -> float:
    """Between `start` and `end`, in equal ratios."""
    return start * (end / start) ** progress
