"""Views as networks take them: fewer, smaller, and with the axes of the picture.

The published networks predict in the part's axes.  Of a part unlike all others one image
does not tell these; those of the picture are known, for every method is given its cameras.
"""

import numpy as np
from jaxtyping import Float, UInt8

from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.geometry.cameras import Cameras


def resize_images(
    images: UInt8[np.ndarray, "n h w 3"], px: int
) -> UInt8[np.ndarray, "n {px} {px} 3"]:
    """`images` at `px` a side, every pixel the mean of those whose centers it covers."""
    from PIL import Image

    resized = [Image.fromarray(one).resize((px, px), Image.Resampling.BOX) for one in images]
    return np.stack([np.asarray(one) for one in resized])


def picture_frames(cameras: Cameras, cube: BoundingCube) -> Float[np.ndarray, "n 3 3"]:
    """A matrix F a view: of points p in the unit cube of `cube`, p @ F are in picture axes.

    They are the camera's axes (x right, y down, z forward) about the center of the part, in units
    of the width that the picture has at the part's distance: what looks twice as large is twice
    as large, whatever the part's longest edge.
    """
    offsets = cube.center_mm - cameras.centers
    depth = np.einsum("ij,ij->i", offsets, cameras.c2w[:, :3, 2])
    width_mm = depth * cameras.width / cameras.K[:, 0, 0]
    return cameras.c2w[:, :3, :3] * (cube.edge_mm / width_mm)[:, None, None]
