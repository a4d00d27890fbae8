"""Views as networks take them: fewer, smaller, and in the axes that the network predicts in.

The published networks predict in the part's axes.  Of a part unlike all others nothing in one
image says where these point; the camera knows, and every method is given its cameras.
"""

import numpy as np
from jaxtyping import Float, Int, UInt8

from industnerf.geometry.cameras import Cameras
from industnerf.schema.training import OutputAxes


def evenly_spaced_indices(total: int, count: int) -> Int[np.ndarray, "_"]:
    """At most `count` of the indices below `total`, evenly spread, the first among them."""
    count = min(count, total)
    return np.arange(count) * total // count


def resize_images(
    images: UInt8[np.ndarray, "n h w 3"], px: int
) -> UInt8[np.ndarray, "n {px} {px} 3"]:
    """`images` at `px` a side, every pixel the mean of those whose centers it covers."""
    from PIL import Image

    resized = [Image.fromarray(one).resize((px, px), Image.Resampling.BOX) for one in images]
    return np.stack([np.asarray(one) for one in resized])


def axis_rotations(cameras: Cameras, axes: OutputAxes) -> Float[np.ndarray, "n 3 3"]:
    """A rotation R a view: of points p in the part's axes, p @ R are in `axes`."""
    if axes == "part":
        return np.tile(np.eye(3), (len(cameras), 1, 1))
    return cameras.c2w[:, :3, :3]


def apply_camera_roll(
    rotations: Float[np.ndarray, "n 3 3"], rolls: Float[np.ndarray, "n 3 3"], axes: OutputAxes
) -> Float[np.ndarray, "n 3 3"]:
    """`rotations` after the cameras rolled by `rolls`, which leave the part's axes alone."""
    return rotations @ rolls if axes == "view" else rotations
