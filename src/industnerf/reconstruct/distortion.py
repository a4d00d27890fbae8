"""Lenses that bend straight lines, and photographs as a pinhole would have taken them.

The model is OpenCV's, with which COLMAP and what writes transforms.json calibrate: a ray (x, y, 1)
of the camera meets the image where a pinhole would have that of

    x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
    y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y,       r^2 = x^2 + y^2
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, UInt8
from scipy.ndimage import map_coordinates

from industnerf.errors import BadArtifact

ZOOMS = (0.5, 4.0)  # a lens that needs another is no photograph's
HALVINGS = 24  # of that interval: to 1e-7 of a focal length
ALONG = np.linspace(0, 1, 65)  # points of each side of the image that are asked


@dataclass(frozen=True)
class Distortion:
    """How a lens bends."""

    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    p1: float = 0.0
    p2: float = 0.0

    def bend(self, xy: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        """Where the rays (x, y, 1) meet the image, in focal lengths from its principal point."""
        x, y = xy[..., 0], xy[..., 1]
        square = x * x + y * y
        radial = 1 + square * (self.k1 + square * (self.k2 + square * self.k3))
        across = self.p1 * (square + 2 * y * y) + 2 * self.p2 * x * y
        along = 2 * self.p1 * x * y + self.p2 * (square + 2 * x * x)
        return np.stack([x * radial + along, y * radial + across], axis=-1)

    def folds(self, radius: float) -> bool:
        """Whether, within `radius`, rays farther out meet the image farther in."""
        square = np.linspace(0, radius, 257) ** 2
        growth = 1 + square * (3 * self.k1 + square * (5 * self.k2 + square * 7 * self.k3))
        return bool((growth <= 0).any())


def straightened(
    image: UInt8[np.ndarray, "h w 3"], K: Float[np.ndarray, "3 3"], lens: Distortion, where: str
) -> tuple[UInt8[np.ndarray, "h w 3"], Float[np.ndarray, "3 3"]]:
    """`image` as a pinhole had taken it, and the pinhole's K.

    Of the same size, and enlarged just so much that no pixel lies beyond the edge of the
    photograph.  Colours are interpolated linearly.  Raises BadArtifact that names the frame if
    there is no such image.
    """
    height, width = image.shape[:2]
    pinhole = K.copy()
    pinhole[[0, 1], [0, 1]] *= _zoom(K, lens, width, height, where)
    column, row = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    px = _seen(np.stack([column, row], axis=-1), pinhole, K, lens) - 0.5
    places = [px[..., 1], px[..., 0]]
    planes = [
        map_coordinates(image[..., channel], places, np.float32, order=1, mode="nearest")
        for channel in range(3)
    ]
    return np.rint(np.stack(planes, axis=-1)).astype(np.uint8), pinhole


def _seen(
    px: Float[np.ndarray, "... 2"],
    pinhole: Float[np.ndarray, "3 3"],
    K: Float[np.ndarray, "3 3"],
    lens: Distortion,
) -> Float[np.ndarray, "... 2"]:
    """Where the photograph shows what `pinhole` would show at `px`."""
    middle, focal = K[:2, 2], K[[0, 1], [0, 1]]
    return middle + focal * lens.bend((px - middle) / pinhole[[0, 1], [0, 1]])


def _zoom(K: Float[np.ndarray, "3 3"], lens: Distortion, width: int, height: int, where: str):
    """The least by which the focal lengths must grow, for no pixel to be missing."""
    size = np.array([width, height], float)
    sides = [np.stack([ALONG, np.full_like(ALONG, at)], axis=1) for at in (0.0, 1.0)]
    border = size * np.concatenate([*sides, *(side[:, ::-1] for side in sides)])

    def whole(zoom: float) -> bool:
        pinhole = K.copy()
        pinhole[[0, 1], [0, 1]] *= zoom
        rays = (border - K[:2, 2]) / pinhole[[0, 1], [0, 1]]
        seen = _seen(border, pinhole, K, lens)
        inside = bool(((seen >= 0) & (seen <= size)).all())
        return inside and not lens.folds(float(np.linalg.norm(rays, axis=1).max()))

    low, high = ZOOMS
    if not whole(high):
        raise BadArtifact(
            f"{where}: {lens} cannot be undone: not even the middle of the image is straightened "
            "by it; are these the coefficients of this lens?"
        )
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (low, middle) if whole(middle) else (middle, high)
    return high
