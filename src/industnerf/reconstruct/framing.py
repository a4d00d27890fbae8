"""What cameras have in frame, and whether they look one way."""

import numpy as np
from jaxtyping import Bool, Float

from industnerf.geometry.cameras import Cameras, project

MIN_AXIS_SPREAD = np.radians(2.0)  # optical axes that spread less give no point where they meet


def in_frame(cameras: Cameras, point: Float[np.ndarray, "3"]) -> Bool[np.ndarray, "n"]:
    """Which cameras have `point` before them and in their image."""
    visible = np.zeros(len(cameras), bool)
    for i, (K, c2w) in enumerate(zip(cameras.K, cameras.c2w, strict=True)):
        if (point - c2w[:3, 3]) @ c2w[:3, 2] > 0:
            u, v = project(point[None], K, c2w)[0][0]
            visible[i] = 0 <= u <= cameras.width and 0 <= v <= cameras.height
    return visible


def axis_spread(cameras: Cameras) -> float:
    """Sine (r.m.s.) of the angles between the optical axes and the direction nearest to all."""
    axes = cameras.c2w[:, :3, 2]
    # 1 - the largest eigenvalue of the mean of a a^T: the mean squared sine to one direction
    mean_squared_sine = 1 - float(np.linalg.eigvalsh(axes.T @ axes / len(axes))[-1])
    return float(np.sqrt(max(mean_squared_sine, 0.0)))
