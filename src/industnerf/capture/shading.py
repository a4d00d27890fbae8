"""What a shader is: from spots on the part to the light that they send to the eye.

Light has one channel or three.  One will do where the part has one albedo and no highlights:
then every colour is the same picture times the `tint`.
"""

from abc import ABC, abstractmethod

import numpy as np
from jaxtyping import Float32

from industnerf.capture.light import Lamps
from industnerf.capture.materials import Materials
from industnerf.capture.surface import Spots


class Shading(ABC):
    """A part's materials under the lamps of one view."""

    tint: tuple[float, ...]  # by colour: radiance over light

    @abstractmethod
    def __call__(self, spots: Spots) -> Float32[np.ndarray, "channels spots"]:
        """The light that `spots` send to the eye, none of it negative."""


class Matte(Shading):
    """Lambert's law: a point is as bright from every side that sees it (photo-consistency)."""

    def __init__(self, materials: Materials, lamps: Lamps) -> None:
        self._lamps, self._of_face = lamps, materials.of_face
        self._plain = len(set(materials.albedo)) == 1
        self.tint = materials.albedo[0] if self._plain else (1.0, 1.0, 1.0)
        self._albedo = np.array(materials.albedo, np.float32).T

    def __call__(self, spots: Spots) -> Float32[np.ndarray, "channels spots"]:
        light = self._lamps.shine(spots.normal)
        if self._plain:
            return light[None]
        return self._albedo.take(self._of_face.take(spots.face), axis=1) * light
