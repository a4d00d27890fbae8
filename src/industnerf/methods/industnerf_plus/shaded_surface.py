"""A surface of signed distances with its light and finishes, rendered by compiled kernels."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp
from jaxtyping import Bool, Float, Float32, Int, Int32
from pykdtree.kdtree import KDTree
from scipy.ndimage import distance_transform_edt

from industnerf.geometry.cameras import Cameras, back_projection
from industnerf.geometry.warp_launch import warp_device
from industnerf.methods.industnerf_plus import surface_kernels
from industnerf.methods.industnerf_plus.distance_grid import DistanceGrid, band_nodes
from industnerf.methods.industnerf_plus.finishes import FinishFit, fit_finishes, refit_lighting
from industnerf.methods.industnerf_plus.lighting import Lighting

ALL_SHADED = 1 << 30
NORMAL_MARGIN = 3.0  # cells beyond the opaque band whose gradients a ray may need
ALBEDO_BAND = 8.0  # cells; a polish moves no surface out of it


class PinholeRays:
    """The rays of all pixels of some cameras, in cells of a grid."""

    def __init__(self, cameras: Cameras, center: np.ndarray, radius: float, grid: DistanceGrid):
        self.width, self.height = cameras.width, cameras.height
        self.pixel_to_ray = np.stack(
            [back_projection(K, c2w) for K, c2w in zip(cameras.K, cameras.c2w, strict=True)]
        )
        self.centers = grid.to_grid((cameras.centers - center) / radius)
        self.axes = cameras.c2w[:, :3, 2]
        self._ray_to_pixel = np.linalg.inv(self.pixel_to_ray)
        self.device_pixel_to_ray = to_device(self.pixel_to_ray, wp.mat33)
        self.device_centers = to_device(self.centers, wp.vec3)

    def directions(self, pixels: Int32[np.ndarray, "n"]) -> Float[np.ndarray, "n 3"]:
        """Unit vectors; a pixel is given by its flat index in all images."""
        view, in_view = np.divmod(pixels, self.width * self.height)
        row, column = np.divmod(in_view, self.width)
        uv = np.stack([column + 0.5, row + 0.5, np.ones(len(pixels))], axis=1)
        directions = np.einsum("nij,nj->ni", self.pixel_to_ray[view], uv)
        return directions / np.linalg.norm(directions, axis=1, keepdims=True)

    def points(
        self, pixels: Int32[np.ndarray, "n"], lengths: Float32[np.ndarray, "n"]
    ) -> Float[np.ndarray, "n 3"]:
        """Points of the rays at these lengths, in cells."""
        origins = self.centers[pixels // (self.width * self.height)]
        return origins + lengths[:, None] * self.directions(pixels)

    def project(
        self, points: Float[np.ndarray, "n 3"], views: Int[np.ndarray, "n"]
    ) -> tuple[Int[np.ndarray, "n"], Bool[np.ndarray, "n"]]:
        """Flat index of the pixel that shows each point in its view, and whether one does."""
        image = np.einsum("nij,nj->ni", self._ray_to_pixel[views], points - self.centers[views])
        column, row = np.floor(image[:, :2] / image[:, 2:]).astype(np.int64).T
        is_in_frame = (
            (image[:, 2] > 0)
            & (np.minimum(row, column) >= 0)
            & (row < self.height)
            & (column < self.width)
        )
        pixel = (views * self.height + row) * self.width + column
        return np.where(is_in_frame, pixel, 0), is_in_frame


@dataclass(frozen=True)
class Rendered:
    """One entry a pixel, on the device."""

    color: Any  # vec3
    opacity: Any
    hit: Any  # cells; -1: no surface


class ShadedSurface:
    """Distances on the device, with the gradients of those near the surface.

    Without light every surface has brightness 1; without albedo all have the same finish.
    """

    def __init__(self, grid: DistanceGrid) -> None:
        self.grid = grid
        self.distance = to_device(grid.distance)
        self.gradient = wp.zeros(grid.hull.shape, wp.vec3, device=warp_device())
        self.finishes: FinishFit | None = None
        self._labeled_points = np.zeros((0, 3))
        self._albedo = wp.zeros((1, 1, 1), wp.vec3, device=warp_device())
        self._set_lighting(Lighting(1.0, np.zeros((0, 3))))

    def set_finishes(self, finishes: FinishFit) -> None:
        """Take light and finishes over; `set_albedo` tells where each finish is."""
        self.finishes = finishes
        self._set_lighting(finishes.lighting)

    def _set_lighting(self, lighting: Lighting) -> None:
        self._ambient = lighting.ambient
        self._lights = to_device(lighting.lights, wp.vec3)

    def shading(self, beta: float, step: float, num_shaded: int = ALL_SHADED) -> Any:
        """What the kernels read beside arrays; lengths are in cells."""
        shading = surface_kernels.Shading()
        shading.beta, shading.step, shading.ambient = beta, step, self._ambient
        shading.has_albedo = int(self._albedo.shape[0] > 1)
        shading.num_shaded = num_shaded
        return shading

    def inputs(self) -> tuple[Any, ...]:
        """The arrays that the kernels read."""
        return self.distance, self.gradient, self._albedo, self._lights

    def update_gradient(self, nodes: Any) -> None:
        """Gradients of the distances at the nodes."""
        launch(surface_kernels.central_differences, len(nodes), nodes, self.distance, self.gradient)

    def update_band(self, beta: float) -> None:
        """Gradients wherever a ray of this softness needs them."""
        width = surface_kernels.OPAQUE_BETAS * beta + NORMAL_MARGIN
        self.update_gradient(to_device(band_nodes(self.distance.numpy(), width), wp.vec3i))

    def render(
        self,
        rays: PinholeRays,
        pixels: Int32[np.ndarray, "n"],
        background: Float[np.ndarray, "views 3"],
        beta: float,
        step: float = 0.5,
        num_shaded: int = ALL_SHADED,
    ) -> Rendered:
        """The pixels; those from `num_shaded` on are white, over black: they tell opacity alone."""
        device, n = warp_device(), len(pixels)
        rendered = Rendered(
            wp.empty(n, wp.vec3, device=device),
            wp.empty(n, wp.float32, device=device),
            wp.empty(n, wp.float32, device=device),
        )
        launch(
            surface_kernels.render,
            n,
            to_device(pixels, wp.int32),
            rays.width,
            rays.height,
            rays.device_pixel_to_ray,
            rays.device_centers,
            to_device(background, wp.vec3),
            *self.inputs(),
            self.shading(beta, step, num_shaded),
            rendered.color,
            rendered.opacity,
            rendered.hit,
        )
        return rendered

    def normals(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Unit normals at points (cells) near the surface, of gradients that are up to date."""
        corner = np.clip(points.astype(int), 0, np.array(self.grid.hull.shape) - 2)
        share = points - corner
        gradient = self.gradient.numpy()
        normals = np.zeros((len(points), 3))
        for offset in np.ndindex(2, 2, 2):
            weight = np.prod(np.where(offset, share, 1 - share), axis=1, keepdims=True)
            normals += weight * gradient[tuple((corner + offset).T)]
        return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-6)

    def fit_light(
        self, points: Float[np.ndarray, "n 3"], rgb: Float[np.ndarray, "n 3"]
    ) -> FinishFit:
        """Fit light and finishes to the colors of points (cells) of the surface.

        A second time the finishes are kept, and the light is refined.
        """
        normals = self.normals(points)
        if self.finishes is None:
            self.finishes = fit_finishes(points, normals, rgb)
        else:
            nearest = KDTree(self._labeled_points).query(points)[1].astype(np.int64)
            self.finishes = refit_lighting(
                self.finishes, self.finishes.label[nearest], normals, rgb
            )
        self._labeled_points = points
        self.set_finishes(self.finishes)
        if len(self.finishes.albedo) > 1:
            self.set_albedo(
                points, np.repeat(self.finishes.albedo[self.finishes.label, None], 3, 1)
            )
        return self.finishes

    def set_albedo(
        self, points: Float[np.ndarray, "n 3"], albedo: Float[np.ndarray, "n 3"]
    ) -> None:
        """Give the nodes near the surface the albedo of the nearest of these points (cells).

        Farther nodes, where a recess may be cut, have that of the nearest node near the surface.
        """
        nodes = band_nodes(self.distance.numpy(), ALBEDO_BAND)
        nearest = KDTree(points).query(nodes.astype(np.float64))[1].astype(np.int64)
        values = np.ones((*self.grid.hull.shape, 3), np.float32)
        values[tuple(nodes.T)] = albedo[nearest]
        is_far = np.ones(self.grid.hull.shape, bool)
        is_far[tuple(nodes.T)] = False
        near = distance_transform_edt(is_far, return_distances=False, return_indices=True)
        self._albedo = to_device(values[tuple(near)], wp.vec3)

    def set_node_albedo(self, albedo: Float32[np.ndarray, "a b c 3"]) -> None:
        """Give every node an albedo of its own."""
        self._albedo = to_device(albedo, wp.vec3)

    def without_light(self) -> None:
        """Brightness 1 of all normals, for colors that tell nothing of them."""
        self.finishes = None
        self._albedo = wp.zeros((1, 1, 1), wp.vec3, device=warp_device())
        self._set_lighting(Lighting(1.0, np.zeros((0, 3))))

    def brightness(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n"]:
        """What light makes of albedo 1 at points (cells) of the surface."""
        if self.finishes is None:
            return np.ones(len(points))
        return self.finishes.lighting.brightness(self.normals(points))

    def set_distance(self, distance: Float32[np.ndarray, "a b c"]) -> None:
        self.grid = DistanceGrid(distance, self.grid.hull, self.grid.lo, self.grid.spacing)
        self.distance = to_device(distance)

    def redistance(self) -> None:
        """Make the distances exact again, inside the hull."""
        grid = DistanceGrid(
            self.distance.numpy(), self.grid.hull, self.grid.lo, self.grid.spacing
        ).redistanced()
        self.set_distance(grid.distance)


def to_device(values: np.ndarray, dtype: Any = wp.float32) -> Any:
    """A Warp array where the kernels run."""
    scalar = np.int32 if dtype in (wp.int32, wp.vec3i) else np.float32
    return wp.array(np.ascontiguousarray(values, scalar), dtype=dtype, device=warp_device())


def launch(kernel: Any, dim: int | tuple[int, ...], *arguments: Any) -> None:
    """Run `kernel` where its arrays are."""
    wp.launch(kernel, dim, list(arguments), device=warp_device())
