"""The cloud: area-uniform points of the surface that some picture shows.

Enclosed air has a surface too, which no picture shows and no evaluation counts.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from industnerf.geometry.isosurface import isosurface
from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.sampling import sample_surface
from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays, ShadedSurface

RAY_OFFSET = 0.5  # cells; a line of sight starts so far before the surface


@dataclass(frozen=True)
class SurfaceSamples:
    """Points of the surface, in cells."""

    points: Float[np.ndarray, "n 3"]
    view: Int[np.ndarray, "n"]  # the most frontal one that shows the point; -1: none
    colors: UInt8[np.ndarray, "n 3"]  # in that view


def sample_visible_surface(
    surface: ShadedSurface, rays: PinholeRays, pictures: Pictures, count: int, seed: int
) -> SurfaceSamples:
    """`count` area-uniform points; none if there is no surface."""
    vertices, faces = isosurface(-surface.distance.numpy(), 0.0, np.zeros(3), 1.0)
    if not len(faces):
        return SurfaceSamples(np.zeros((0, 3)), np.zeros(0, int), np.zeros((0, 3), np.uint8))
    points, _ = sample_surface(vertices, faces, count, np.random.default_rng(seed))
    view = best_views(RaycastingScene(vertices, faces), points, surface.normals(points), rays)
    pixel, _ = rays.project(points, np.maximum(view, 0))
    colors = pictures.rgb[np.where(view >= 0, pixel, 0)]
    return SurfaceSamples(points, view, colors)


def best_views(
    scene: RaycastingScene,
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    rays: PinholeRays,
) -> Int[np.ndarray, "n"]:
    """Of the views that see each point the one that looks at it most directly; -1: none does."""
    cosine = np.stack(
        [(unit_vectors(center - points) * normals).sum(axis=1) for center in rays.centers], axis=1
    )
    order = np.argsort(-cosine, axis=1, kind="stable")
    best = np.full(len(points), -1)
    for views in order.T:
        left = np.flatnonzero(best < 0)
        if not len(left):
            break
        is_seen = sees(scene, points[left], views[left], rays)
        best[left[is_seen]] = views[left[is_seen]]
    return best


def sees(
    scene: RaycastingScene,
    points: Float[np.ndarray, "n 3"],
    views: Int[np.ndarray, "n"],
    rays: PinholeRays,
) -> Bool[np.ndarray, "n"]:
    """Whether nothing is between each point and the center of its view, and it is in frame."""
    direction = unit_vectors(rays.centers[views] - points)
    _, is_in_frame = rays.project(points, views)
    return is_in_frame & ~scene.is_occluded(points + RAY_OFFSET * direction, direction)


def unit_vectors(vectors: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
