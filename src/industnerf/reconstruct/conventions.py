"""The two commonest mistakes with poses, told by what the cameras would have in frame without."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.views import OPENGL
from industnerf.geometry.cameras import Cameras, common_view_ball
from industnerf.reconstruct.framing import MIN_AXIS_SPREAD, axis_spread, in_frame

Matrices = Float[np.ndarray, "n 4 4"]

# of matrices as a file has them: our axes are OpenCV's, and its are presumed to be OpenGL's
CONVENTIONS: dict[str, Callable[[Matrices], Matrices]] = {
    "have OpenCV's axes (y down, z forwards): negate the second and third column of each": (
        lambda matrices: matrices
    ),
    "are world-to-camera: invert each": lambda matrices: np.linalg.inv(matrices) @ OPENGL,
    "are world-to-camera with OpenCV's axes, as COLMAP's are: invert each, then negate its second "
    "and third column": np.linalg.inv,
}
CONVENTION_HINT = (
    "are the matrices camera-to-world, with OpenGL's axes (x to the right, y up, z backwards), "
    "and in one frame and unit?"
)


def detect_convention_error(cameras: Cameras, center: Float[np.ndarray, "3"] | None) -> str | None:
    """What the matrices look like, if all of `cameras` then have the point in frame; else None.

    The point is `center`, or where the optical axes come nearest to each other.  Cameras that have
    such a point in frame as they are look like nothing else, wherever `center` is.
    """
    if _all_have_in_frame(cameras, None):
        return None
    for description, convert in CONVENTIONS.items():
        reinterpreted = replace(cameras, c2w=convert(cameras.c2w @ OPENGL))
        if _all_have_in_frame(reinterpreted, center):
            return f"it looks as if the matrices {description}; then all have one point in frame"
    return None


def _all_have_in_frame(cameras: Cameras, center: Float[np.ndarray, "3"] | None) -> bool:
    if center is None:
        if axis_spread(cameras) < np.sin(MIN_AXIS_SPREAD):
            return False
        center = common_view_ball(cameras)[0]
    return bool(in_frame(cameras, center).all())
