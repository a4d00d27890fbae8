"""Cameras as a calibration would report them: wrong, while the photographs stay as they are.

`views.calibration` states root mean squares over many views: of the angle between true and
recorded axes, of the distance between true and recorded eyes, and of the focal length's error.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.transform import Rotation

from industnerf.capture.rng import RandomStreams
from industnerf.geometry.cameras import Cameras
from industnerf.schema import CalibrationParams


def is_exact(calibration: CalibrationParams) -> bool:
    """Whether the recorded cameras are the true ones."""
    return not any(vars(calibration).values())


def perturbed_cameras(
    cameras: Cameras,
    held_out: Bool[np.ndarray, "n"],
    center: Float[np.ndarray, "3"],
    calibration: CalibrationParams,
    view_streams: list[RandomStreams],
) -> Cameras:
    """What is written down of the true `cameras`: training cameras off, held-out ones exact.

    Held-out views judge; were their cameras wrong, they would judge the calibration too.
    """
    if is_exact(calibration):
        return cameras
    K, c2w = cameras.K.copy(), cameras.c2w.copy()
    for i in np.flatnonzero(~held_out):
        rng = view_streams[i].generator("calibration")
        axis, step = rng.standard_normal((2, 3))
        angle, stretch = rng.standard_normal(2)
        angle *= np.radians(calibration.rotation_deg)
        rotation = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()
        c2w[i, :3, :3] = rotation @ c2w[i, :3, :3]
        distance = np.linalg.norm(cameras.centers[i] - center)
        c2w[i, :3, 3] += calibration.position * distance * step / np.sqrt(3)  # three coordinates
        # never negative, and a share of the focal length to first order
        K[i, [0, 1], [0, 1]] *= np.exp(calibration.focal * stretch)
    return Cameras(K, c2w, cameras.width, cameras.height)
