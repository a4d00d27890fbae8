"""Ambient light and distant lamps, fixed to the part unless `views.light` jitters them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32
from scipy.spatial.transform import Rotation

from industnerf.capture.rng import RandomStreams
from industnerf.schema import LightParams


@dataclass(frozen=True)
class Lights:
    """Ambient light and distant lamps."""

    ambient: np.float32
    directions: Float32[np.ndarray, "lamps 3"]  # unit
    intensity: Float32[np.ndarray, "lamps"]

    @staticmethod
    def from_params(light: LightParams) -> "Lights":
        """`light` as arrays."""
        directions = np.array(light.directions, np.float32).reshape(-1, 3)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        return Lights(
            np.float32(light.ambient), directions, np.array(light.intensities, np.float32)
        )

    def shade(self, normals: Float32[np.ndarray, "3 n"]) -> Float32[np.ndarray, "n"]:
        """Lambert's law: ambient + sum of intensity * max(0, cosine); normals of any length."""
        length = np.sqrt(np.einsum("ij,ij->j", normals, normals))
        diffuse = self.intensity @ np.maximum(self.directions @ normals, 0)
        return np.maximum(self.ambient + diffuse / np.maximum(length, np.float32(1e-12)), 0)


def view_lights(light: LightParams, streams: RandomStreams) -> Lights:
    """The lamps of one view.

    All of them are rotated as one about a random axis, by an angle uniform within
    `rotation_jitter_deg`, and each is brighter or darker by a share uniform within
    `intensity_jitter`.
    """
    lights = Lights.from_params(light)
    if not (light.rotation_jitter_deg or light.intensity_jitter):
        return lights
    rng = streams.generator("light")
    axis, angle = rng.standard_normal(3), rng.uniform(-1, 1) * np.radians(light.rotation_jitter_deg)
    rotation = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()
    intensity_scale = 1 + light.intensity_jitter * rng.uniform(-1, 1, len(lights.intensity))
    return Lights(
        lights.ambient,
        (lights.directions @ rotation.T).astype(np.float32),
        (lights.intensity * intensity_scale).astype(np.float32),
    )
