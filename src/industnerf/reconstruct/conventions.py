"""The two commonest mistakes with poses, told by what the cameras would have in frame without."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.views import OPENGL
from industnerf.geometry.cameras import Cameras, framed_ball
from industnerf.reconstruct.framing import SAME_WAY, in_frame, spread

Matrices = Float[np.ndarray, "n 4 4"]

# of matrices as a file has them: our axes are OpenCV's, and its are presumed to be OpenGL's
READINGS: dict[str, Callable[[Matrices], Matrices]] = {
    "have OpenCV's axes (y down, z forwards): negate the second and third column of each": (
        lambda file: file
    ),
    "are world-to-camera: invert each": lambda file: np.linalg.inv(file) @ OPENGL,
    "are world-to-camera with OpenCV's axes, as COLMAP's are: invert each, then negate its second "
    "and third column": np.linalg.inv,
}
ASKED = (
    "are the matrices camera-to-world, with OpenGL's axes (x to the right, y up, z backwards), "
    "and in one frame and unit?"
)


def likely_mistake(cameras: Cameras, centre: Float[np.ndarray, "3"] | None) -> str | None:
    """What the matrices look like, if all of `cameras` then have the point in frame; else None.

    The point is `centre`, or where the optical axes come nearest to each other.  Cameras that have
    such a point in frame as they are look like nothing else, wherever `centre` is.
    """
    if _all_see(cameras, None):
        return None
    for words, read in READINGS.items():
        otherwise = replace(cameras, c2w=read(cameras.c2w @ OPENGL))
        if _all_see(otherwise, centre):
            return f"it looks as if the matrices {words}; then all have one point in frame"
    return None


def _all_see(cameras: Cameras, centre: Float[np.ndarray, "3"] | None) -> bool:
    if centre is None:
        if spread(cameras) < np.sin(SAME_WAY):
            return False
        centre = framed_ball(cameras)[0]
    return bool(in_frame(cameras, centre).all())
