"""Soft shadows: how much of a lamp, a disc in the sky, a surface point sees."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Float32

from industnerf.capture.edges import hammersley_points
from industnerf.capture.ray_hits import Surface, SurfacePoints
from industnerf.geometry.cameras import look_at

RAY_OFFSET = 1e-4  # how far above the surface a shadow ray begins, in sizes of the part
NUM_PROBES = 4  # rays that decide whether the others of a lamp are needed

Points = Float32[np.ndarray, "points 3"]


class ShadowedLights(NamedTuple):
    """What surface points see of one lamp."""

    visible_share: Float32[np.ndarray, "n"]  # of the disc
    mean_cosine: Float32[np.ndarray, "n"]  # to the normal, mean over the disc; 0 for what is hidden


class Shadows:
    """Rays towards fixed points of every lamp: no chance, hence no noise and no seed.

    The NUM_PROBES points nearest to the rim of a lamp's disc are tried first.  Where they agree
    the others are taken to agree with them: a wire thin enough to hide the middle alone is missed.
    """

    def __init__(self, surface: Surface, light_half_angle_deg: float, samples: int) -> None:
        self._surface, self._samples = surface, samples
        self._disc_radius = np.tan(np.radians(light_half_angle_deg))
        self._offset_mm = RAY_OFFSET * float(np.ptp(surface.vertices, axis=0).max())

    def ray_origins(
        self, hits: SurfacePoints, normal: Float32[np.ndarray, "3 n"]
    ) -> Float[np.ndarray, "n 3"]:
        """Where the shadow rays of `hits` begin, mm; `normal` has unit length."""
        return self._surface.offset_along_normal(hits) + self._offset_mm * normal.T

    def light_visibility(
        self,
        ray_origins: Float[np.ndarray, "n 3"],
        normal: Float32[np.ndarray, "3 n"],
        light_dir: Float32[np.ndarray, "3"],
    ) -> ShadowedLights:
        """What `ray_origins` see of the lamp around `light_dir`, above each one's horizon."""
        disc = disc_directions(light_dir, self._disc_radius, self._samples)
        cosine = np.maximum(disc @ normal, 0)
        is_seen = cosine > 0
        above_horizon = np.flatnonzero(is_seen.any(axis=0))
        is_seen[-NUM_PROBES:, above_horizon] &= self._is_unblocked(
            ray_origins[above_horizon], disc[-NUM_PROBES:]
        )
        probe_share = is_seen[-NUM_PROBES:, above_horizon].mean(axis=0)
        is_seen[:, above_horizon[probe_share == 0]] = False
        is_partial = above_horizon[(probe_share > 0) & (probe_share < 1)]
        is_seen[:-NUM_PROBES, is_partial] &= self._is_unblocked(
            ray_origins[is_partial], disc[:-NUM_PROBES]
        )
        cosine *= is_seen
        return ShadowedLights(is_seen.mean(axis=0, dtype=np.float32), cosine.mean(axis=0))

    def _is_unblocked(
        self, ray_origins: Float[np.ndarray, "m 3"], points: Points
    ) -> Bool[np.ndarray, "points m"]:
        """Whether each of `points` of the lamp is seen from each of `ray_origins`."""
        is_unblocked = np.empty((len(points), len(ray_origins)), bool)
        for row, point in zip(is_unblocked, points, strict=True):
            row[:] = ~self._surface.scene.is_occluded(
                ray_origins, np.tile(point, (len(ray_origins), 1))
            )
        return is_unblocked


def disc_directions(light_dir: Float32[np.ndarray, "3"], radius: float, samples: int) -> Points:
    """Unit vectors to points, even in area, of a disc of `radius` at the distance 1.

    They come from its middle to its rim, and any four in a row stand on four sides of it.
    """
    share, turns = hammersley_points(samples).T.astype(np.float64)
    angle, distance = 2 * np.pi * turns, radius * np.sqrt(share)
    # as a camera in the middle would see it: the lamp's own right and down
    axes = look_at(np.zeros((1, 3)), light_dir.astype(np.float64))[0, :3, :2]
    points = light_dir + (distance * np.stack([np.cos(angle), np.sin(angle)])).T @ axes.T
    return (points / np.linalg.norm(points, axis=1, keepdims=True)).astype(np.float32)
