"""Lamps: ambient light and distant lamps, fixed to the part unless they sway."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32
from scipy.spatial.transform import Rotation

from industnerf.capture.chance import Draws
from industnerf.schema import LightParams


@dataclass(frozen=True)
class Lamps:
    """Ambient light and distant lamps."""

    ambient: np.float32
    towards: Float32[np.ndarray, "lamps 3"]  # unit
    intensity: Float32[np.ndarray, "lamps"]

    @staticmethod
    def of(light: LightParams) -> "Lamps":
        """`light` as arrays."""
        towards = np.array(light.directions, np.float32).reshape(-1, 3)
        towards /= np.linalg.norm(towards, axis=1, keepdims=True)
        return Lamps(np.float32(light.ambient), towards, np.array(light.intensities, np.float32))

    def shine(self, normals: Float32[np.ndarray, "3 n"]) -> Float32[np.ndarray, "n"]:
        """Lambert's law: ambient + sum of intensity * max(0, cosine); normals of any length."""
        length = np.sqrt(np.einsum("ij,ij->j", normals, normals))
        lit = self.intensity @ np.maximum(self.towards @ normals, 0)
        return np.maximum(self.ambient + lit / np.maximum(length, np.float32(1e-12)), 0)


def lamps_of(light: LightParams, draws: Draws) -> Lamps:
    """The lamps of one view.

    All of them are turned as one about a random axis, by an angle uniform within `sway_deg`,
    and each is brighter or darker by a share uniform within `flicker`.
    """
    lamps = Lamps.of(light)
    if not (light.sway_deg or light.flicker):
        return lamps
    rng = draws.of("light")
    axis, angle = rng.standard_normal(3), rng.uniform(-1, 1) * np.radians(light.sway_deg)
    turn = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()
    change = 1 + light.flicker * rng.uniform(-1, 1, len(lamps.intensity))
    return Lamps(
        lamps.ambient,
        (lamps.towards @ turn.T).astype(np.float32),
        (lamps.intensity * change).astype(np.float32),
    )
