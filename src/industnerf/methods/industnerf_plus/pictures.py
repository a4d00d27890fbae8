"""The photographs as the polish of a surface reads them: which of their pixels can be trusted."""

import numpy as np
from jaxtyping import Bool, Float, Float32, Int32, UInt8
from scipy.ndimage import maximum_filter, minimum_filter

from industnerf.geometry.silhouettes import background_noise

EDGE_CONTRAST = 0.08  # of brightness in [0, 1], within one pixel
EDGE_NOISES = 5.0  # and more than so many times the noise of the background
EDGE_GROWTH = 2  # px
EDGE_SHARE = 0.15  # of the pixels beside edges that count


class Pictures:
    """Brightness of all pixels, flat, and how far each is from an outline or an edge.

    Beside a jump of brightness a soft surface mixes what is on both sides, so few of the pixels
    there count.
    """

    def __init__(
        self,
        rgb: UInt8[np.ndarray, "n h w 3"],
        background: Float[np.ndarray, "n 3"],
        outlines: Float32[np.ndarray, "n h w"],
    ) -> None:
        self.rgb = rgb.reshape(-1, 3)
        self.background = background
        self.gray_background = np.repeat(background.mean(axis=1, keepdims=True), 3, axis=1)
        gray = rgb.mean(axis=3, dtype=np.float32) / 255
        noise = max(
            background_noise(image, color) for image, color in zip(rgb, background, strict=True)
        )
        self.gray = gray.ravel()
        self._outlines = outlines.ravel()
        self._is_edge = edge_mask(gray, EDGE_CONTRAST + EDGE_NOISES * noise).ravel()

    def is_inside(self, pixels: Int32[np.ndarray, "n"]) -> Bool[np.ndarray, "n"]:
        """Whether pixels show nothing but the part."""
        return self._outlines[pixels] > 1

    def is_edge(self, pixels: Int32[np.ndarray, "n"]) -> Bool[np.ndarray, "n"]:
        """Whether pixels are beside a jump of brightness."""
        return self._is_edge[pixels]

    def shaded_pixels(
        self, margin: float, edge_share: float, rng: np.random.Generator
    ) -> Int32[np.ndarray, "m"]:
        """Pixels more than `margin` px inside the outline, and a share of those beside edges."""
        is_kept = rng.random(len(self._is_edge), dtype=np.float32) < edge_share
        return np.flatnonzero((self._outlines > margin) & (~self._is_edge | is_kept)).astype(
            np.int32
        )

    def opaque_pixels(self, margin: float) -> Int32[np.ndarray, "m"]:
        """The other pixels that show the part, and nothing but the part."""
        is_covered = self._outlines > 1
        return np.flatnonzero(is_covered & ((self._outlines <= margin) | self._is_edge)).astype(
            np.int32
        )


def edge_mask(gray: Float32[np.ndarray, "n h w"], contrast: float) -> Bool[np.ndarray, "n h w"]:
    """Pixels within EDGE_GROWTH of a jump of brightness."""
    mask = np.zeros(gray.shape, bool)
    for image, target in zip(gray, mask, strict=True):
        jump = maximum_filter(image, 3) - minimum_filter(image, 3) > contrast
        target[:] = maximum_filter(jump, 2 * EDGE_GROWTH + 1)
    return mask
