"""Parallel beams of rays at a mesh, from all round."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

from industnerf.geometry.sphere import fibonacci_sphere


def parallel_ray_bundles(
    vertices: Float[np.ndarray, "n 3"], views: int, rays_across: int
) -> Iterator[tuple[Float[np.ndarray, "rays 3"], Float[np.ndarray, "3"]]]:
    """`views` beams, each a square grid of `rays_across`**2 origins (mm) and its unit direction.

    Every beam is as wide as the bounding box's diagonal and starts outside the box.
    """
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    radius = 0.5 * float(np.linalg.norm(high - low))
    offsets = radius * (2 * np.arange(rays_across) + 1 - rays_across) / rays_across
    grid = np.stack(np.meshgrid(offsets, offsets), axis=-1).reshape(-1, 2)
    for direction in fibonacci_sphere(views):
        plane_axes = np.linalg.svd(direction[None])[2][1:]  # two unit vectors across the beam
        yield (low + high) / 2 - 2 * radius * direction + grid @ plane_axes, direction
