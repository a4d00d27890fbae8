"""Colors and confidence at the nodes about a surface, from all pictures.

The color of a node is the mean of the pixels that see the surface there, free of the light on it.

    confidence = mean of (12) over these pixels / (1 + depth / HALVING_DEPTH)

(12) says how well the photographs fit, and a filled recess fits them too.  Silhouettes hold the
surface where it lies on the visual hull; the deeper it is in the hull, the more is a guess.
"""

import numpy as np
import torch
from jaxtyping import Float, Float32, Int64, Shaped
from scipy.ndimage import distance_transform_edt, gaussian_filter, map_coordinates

from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.polish import LIGHT_BETA
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays, ShadedSurface
from industnerf.rendering.confidence import color_confidence, color_scale

MIN_SHADE = 0.05
SMOOTHING = 1.0  # cells
MIN_WEIGHT = 1e-3
PIXEL_STEP = 4  # every so many pixels in both directions
HALVING_DEPTH = 10.0  # cells inside the visual hull


class Appearance:
    """What is seen of the surface, at the nodes of its grid."""

    def __init__(self, surface: ShadedSurface, rays: PinholeRays, pictures: Pictures) -> None:
        surface.update_band(LIGHT_BETA)
        pixels = pixel_lattice(len(rays.centers), rays.height, rays.width, PIXEL_STEP)
        pixels = pixels[pictures.is_inside(pixels)]
        hit = surface.render(rays, pixels, pictures.background, LIGHT_BETA).hit.numpy()
        pixels, hit = pixels[hit > 0], hit[hit > 0]
        points = rays.points(pixels, hit)
        shade = np.maximum(surface.brightness(points), MIN_SHADE)[:, None]
        rgb = pictures.rgb[pixels] / 255
        node = np.ravel_multi_index(tuple(np.rint(points).astype(int).T), surface.grid.hull.shape)
        self._hull, self._shape = surface.grid.hull, surface.grid.hull.shape
        self._weight = self._smooth(np.bincount(node, minlength=int(np.prod(self._shape))))
        self._is_seen = self._weight > MIN_WEIGHT
        self.albedo = self._mean(node, rgb / shade)
        predicted = self.albedo.reshape(-1, 3)[node] * shade
        confidence = color_confidence(
            torch.from_numpy(rgb), torch.from_numpy(predicted), color_scale("max", 1.0)
        ).numpy()
        self._confidence = self._mean(node, confidence[:, None])[..., 0]

    def _smooth(self, values: Shaped[np.ndarray, "nodes"]) -> Float32[np.ndarray, "a b c"]:
        return gaussian_filter(values.astype(np.float32).reshape(self._shape), SMOOTHING)

    def _mean(
        self, node: Int64[np.ndarray, "n"], values: Float[np.ndarray, "n d"]
    ) -> Float32[np.ndarray, "a b c d"]:
        """Mean of the values at each node; where there are none, that of the nearest node."""
        size = int(np.prod(self._shape))
        total = np.stack(
            [self._smooth(np.bincount(node, column, size)) for column in values.T], axis=-1
        )
        mean = total / np.maximum(self._weight, MIN_WEIGHT)[..., None]
        if not self._is_seen.any():
            return np.full_like(mean, 0.5)
        nearest = distance_transform_edt(
            ~self._is_seen, return_distances=False, return_indices=True
        )
        return mean[tuple(nearest)]

    def confidence(self, points: Float[np.ndarray, "n 3"]) -> Float32[np.ndarray, "n"]:
        """Confidence at points (cells), in [0, 1]."""
        agreement = self._confidence[tuple(np.rint(points).astype(int).T)]
        depth = np.maximum(-map_coordinates(self._hull, points.T, order=1), 0)
        return np.clip(agreement / (1 + depth / HALVING_DEPTH), 0, 1).astype(np.float32)


def pixel_lattice(views: int, height: int, width: int, step: int) -> np.ndarray:
    """Flat indices of every so many pixels of all images."""
    mask = np.zeros((views, height, width), bool)
    mask[:, step // 2 :: step, step // 2 :: step] = True
    return np.flatnonzero(mask).astype(np.int32)
