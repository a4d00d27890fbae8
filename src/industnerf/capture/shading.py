"""The interface of shading: from surface points to the radiance that they send to the camera.

Radiance has one channel or three.  One will do where the part has one albedo and no highlights:
then every color is the same picture times the `tint`.
"""

from abc import ABC, abstractmethod

import numpy as np
from jaxtyping import Float32

from industnerf.capture.light import Lights
from industnerf.capture.materials import Materials
from industnerf.capture.ray_hits import SurfacePoints


class Shading(ABC):
    """A part's materials under the lamps of one view."""

    tint: tuple[float, ...]  # by color: what the radiance is multiplied by

    @abstractmethod
    def __call__(self, hits: SurfacePoints) -> Float32[np.ndarray, "channels hits"]:
        """The radiance that `hits` send to the camera, none of it negative."""


class LambertianShading(Shading):
    """Lambert's law: a point is as bright from every side that sees it (photo-consistency)."""

    def __init__(self, materials: Materials, lights: Lights) -> None:
        self._lights, self._face_material = lights, materials.face_material
        self._is_uniform = len(set(materials.albedo)) == 1
        self.tint = materials.albedo[0] if self._is_uniform else (1.0, 1.0, 1.0)
        self._albedo = np.array(materials.albedo, np.float32).T

    def __call__(self, hits: SurfacePoints) -> Float32[np.ndarray, "channels hits"]:
        irradiance = self._lights.shade(hits.normal)
        if self._is_uniform:
            return irradiance[None]
        return self._albedo.take(self._face_material.take(hits.face), axis=1) * irradiance
