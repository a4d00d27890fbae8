"""Structural similarity -- Wang et al. (2004), eq. 13, with their window and constants."""

import numpy as np
from jaxtyping import Float
from scipy.ndimage import correlate1d

SIGMA, HALF_WINDOW = 1.5, 5  # px: a Gaussian window of 11 x 11
K1, K2 = 0.01, 0.03  # colors lie in [0, 1], so the constants are K1^2 and K2^2


def window() -> Float[np.ndarray, "11"]:
    """The weights of one row of the window, which sum to 1."""
    weights = np.exp(-(np.arange(-HALF_WINDOW, HALF_WINDOW + 1) ** 2) / (2 * SIGMA**2))
    return weights / weights.sum()


def ssim_map(
    a: Float[np.ndarray, "h w c"], b: Float[np.ndarray, "h w c"]
) -> Float[np.ndarray, "h w"]:
    """Similarity in [-1, 1] about each pixel, the mean of the channels; 1 where both are equal.

    Beyond the border the pictures are mirrored; the original leaves 5 px of border out instead.
    """
    mean_a, mean_b = _smooth(a), _smooth(b)
    var_a, var_b = _smooth(a * a) - mean_a**2, _smooth(b * b) - mean_b**2
    covariance = _smooth(a * b) - mean_a * mean_b
    numerator = (2 * mean_a * mean_b + K1**2) * (2 * covariance + K2**2)
    return (numerator / ((mean_a**2 + mean_b**2 + K1**2) * (var_a + var_b + K2**2))).mean(axis=-1)


def _smooth(image: Float[np.ndarray, "h w c"]) -> Float[np.ndarray, "h w c"]:
    return correlate1d(correlate1d(image, window(), axis=0), window(), axis=1)
