"""The axes that a net of one view answers in: the part's, or those of the camera.

The published nets answer in the part's.  Of a part unlike all others nothing in one picture says
where these point; the camera knows, and every method is given its cameras.
"""

import numpy as np
from jaxtyping import Float

from industnerf.geometry.cameras import Cameras
from industnerf.schema.training import OutputAxes


def axis_rotations(cameras: Cameras, axes: OutputAxes) -> Float[np.ndarray, "n 3 3"]:
    """Of points p in the part's axes, p @ turn are in those of `frame`, view by view."""
    if axes == "part":
        return np.tile(np.eye(3), (len(cameras), 1, 1))
    return cameras.c2w[:, :3, :3]


def apply_camera_roll(
    rotations: Float[np.ndarray, "n 3 3"], rolls: Float[np.ndarray, "n 3 3"], axes: OutputAxes
) -> Float[np.ndarray, "n 3 3"]:
    """`turns` after the cameras rolled by `rolls`, of which the part's axes know nothing."""
    return rotations @ rolls if axes == "view" else rotations
