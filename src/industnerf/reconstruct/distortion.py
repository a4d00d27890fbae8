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

ZOOM_RANGE = (0.5, 4.0)  # a lens that needs another is no photograph's
BISECTION_STEPS = 24  # of that interval: to 1e-7 of a focal length
EDGE_SAMPLES = np.linspace(0, 1, 65)  # points of each side of the image that are asked


@dataclass(frozen=True)
class Distortion:
    """How a lens bends."""

    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    p1: float = 0.0
    p2: float = 0.0

    def distort(self, xy: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        """Where the rays (x, y, 1) meet the image, in focal lengths from its principal point."""
        x, y = xy[..., 0], xy[..., 1]
        r2 = x * x + y * y
        radial = 1 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3))
        tangential_y = self.p1 * (r2 + 2 * y * y) + 2 * self.p2 * x * y
        tangential_x = 2 * self.p1 * x * y + self.p2 * (r2 + 2 * x * x)
        return np.stack([x * radial + tangential_x, y * radial + tangential_y], axis=-1)

    def has_folds(self, radius: float) -> bool:
        """Whether, within `radius`, rays farther out meet the image farther in."""
        r2 = np.linspace(0, radius, 257) ** 2
        radial_derivative = 1 + r2 * (3 * self.k1 + r2 * (5 * self.k2 + r2 * 7 * self.k3))
        return bool((radial_derivative <= 0).any())


def undistort(
    image: UInt8[np.ndarray, "h w 3"],
    K: Float[np.ndarray, "3 3"],
    distortion: Distortion,
    frame_label: str,
) -> tuple[UInt8[np.ndarray, "h w 3"], Float[np.ndarray, "3 3"]]:
    """`image` as a pinhole had taken it, and the pinhole's K.

    Of the same size, and enlarged just so much that no pixel lies beyond the edge of the
    photograph.  Colors are interpolated linearly.  Raises BadArtifact that names the frame if
    there is no such image.
    """
    height, width = image.shape[:2]
    pinhole_K = K.copy()
    pinhole_K[[0, 1], [0, 1]] *= _min_zoom(K, distortion, width, height, frame_label)
    column, row = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    source_px = _distorted_pixels(np.stack([column, row], axis=-1), pinhole_K, K, distortion) - 0.5
    coordinates = [source_px[..., 1], source_px[..., 0]]
    channels = [
        map_coordinates(image[..., channel], coordinates, np.float32, order=1, mode="nearest")
        for channel in range(3)
    ]
    return np.rint(np.stack(channels, axis=-1)).astype(np.uint8), pinhole_K


def _distorted_pixels(
    px: Float[np.ndarray, "... 2"],
    pinhole_K: Float[np.ndarray, "3 3"],
    K: Float[np.ndarray, "3 3"],
    distortion: Distortion,
) -> Float[np.ndarray, "... 2"]:
    """Where the photograph shows what `pinhole` would show at `px`."""
    principal_point, focal = K[:2, 2], K[[0, 1], [0, 1]]
    return principal_point + focal * distortion.distort(
        (px - principal_point) / pinhole_K[[0, 1], [0, 1]]
    )


def _min_zoom(
    K: Float[np.ndarray, "3 3"], distortion: Distortion, width: int, height: int, frame_label: str
):
    """The least by which the focal lengths must grow, for no pixel to be missing."""
    size = np.array([width, height], float)
    sides = [
        np.stack([EDGE_SAMPLES, np.full_like(EDGE_SAMPLES, edge)], axis=1) for edge in (0.0, 1.0)
    ]
    border = size * np.concatenate([*sides, *(side[:, ::-1] for side in sides)])

    def is_complete(zoom: float) -> bool:
        pinhole_K = K.copy()
        pinhole_K[[0, 1], [0, 1]] *= zoom
        rays = (border - K[:2, 2]) / pinhole_K[[0, 1], [0, 1]]
        source_px = _distorted_pixels(border, pinhole_K, K, distortion)
        is_inside = bool(((source_px >= 0) & (source_px <= size)).all())
        return is_inside and not distortion.has_folds(float(np.linalg.norm(rays, axis=1).max()))

    low, high = ZOOM_RANGE
    if not is_complete(high):
        raise BadArtifact(
            f"{frame_label}: {distortion} cannot be undone: not even the middle of the image is straightened "
            "by it; are these the coefficients of this lens?"
        )
    for _ in range(BISECTION_STEPS):
        middle = (low + high) / 2
        low, high = (low, middle) if is_complete(middle) else (middle, high)
    return high
