"""Silhouettes from color, and how far each pixel is from their outline."""

from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float, Float32, UInt8
from scipy.ndimage import minimum_filter, uniform_filter

# The noise of an image is the distance from the background that this share of its border keeps.
BORDER_QUANTILE = 0.75
MAX_NOISE = 0.1  # in [0, 1]; if most of the border is farther off, the frame cuts the part
NOISE_FACTOR = 2.5  # Gaussian noise stays within so many: 4.2 sigma, 3.3 where it is cut off at 1
ROUNDING = 0.003  # in [0, 1]; a color in 8 bits is off by no more
SPECK_SIZE = 2.5  # of the nine pixels in a square: a wire has three of them, a speck seldom
MAX_DISTANCE_PX = 11  # px; distances are exact up to here, and d^2 + (d - 1)^2 fits 8 bits
BOUNDARY_OFFSET_PX = 0.5  # px; a pixel that shows any of the part lies on average half outside it


def foreground_mask(
    rgb: UInt8[np.ndarray, "n h w 3"], background: Float[np.ndarray, "n 3"], tolerance: float
) -> Bool[np.ndarray, "n h w"]:
    """The pixels that show the part: what differs from its view's background, in [0, 1].

    By more than `tolerance`, and by more than the background's noise, which the border of each
    image shows.  Where noise may pass the tolerance, faces nearly as bright as the background
    are told by the mean of nine pixels, and specks and pinholes are removed.
    """
    masks = []
    for image, color in zip(rgb, background, strict=True):
        noise = NOISE_FACTOR * background_noise(image, color)
        mask = differs_from_background(image[None], color[None], max(tolerance, noise))[0]
        if 2 * noise > tolerance:
            mask = remove_specks(mask | low_contrast_mask(image, max(tolerance, noise / 3)))
        masks.append(mask)
    return np.stack(masks)


def background_noise(
    image: UInt8[np.ndarray, "h w 3"], background: Float[np.ndarray, "3"]
) -> float:
    """How far, in its worst channel, most of the border is from the background, in [0, 1]."""
    difference = np.abs(border(image) / 255 - background).max(axis=1)
    quantile = float(np.quantile(difference, BORDER_QUANTILE))
    return quantile if ROUNDING < quantile < MAX_NOISE else 0.0


def border(image: UInt8[np.ndarray, "h w 3"]) -> UInt8[np.ndarray, "_ 3"]:
    """The outermost pixels: the part is in frame, so they show the background."""
    return np.concatenate([image[0], image[-1], image[1:-1, 0], image[1:-1, -1]])


def low_contrast_mask(
    image: UInt8[np.ndarray, "h w 3"], tolerance: float
) -> Bool[np.ndarray, "h w"]:
    """Where all means of nine pixels about it, in [0, 1], differ from that of the border.

    The mean of nine has a third of the noise, and one that reaches over the outline does not
    count.  Noise before white is cut off, so its mean is darker than white: hence the border's.
    """
    means = uniform_filter(image.astype(np.float32) / 255, (3, 3, 0), mode="nearest")
    difference = np.abs(means - border(image).mean(axis=0, dtype=np.float32) / 255).max(axis=2)
    return minimum_filter(difference, 3, mode="nearest") > tolerance


def remove_specks(mask: Bool[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Each pixel as all but two of the nine about it, where so many are alike."""
    neighbor_count = uniform_filter(np.float32(9) * mask, 3, mode="nearest")
    return (mask & (neighbor_count > SPECK_SIZE)) | (neighbor_count > 9 - SPECK_SIZE)


def differs_from_background(
    rgb: UInt8[np.ndarray, "n h w 3"], background: Float[np.ndarray, "n 3"], tolerance: float
) -> Bool[np.ndarray, "n h w"]:
    """Whether any channel is farther than `tolerance` from its view's background, in [0, 1]."""
    levels = np.arange(256)[:, None] / 255
    masks = np.zeros(rgb.shape[:3], bool)
    for mask, image, color in zip(masks, rgb, background, strict=True):
        lookup = np.abs(levels - color) > tolerance
        for channel in range(3):
            mask |= lookup[image[..., channel], channel]
    return masks


def silhouette_distances(masks: Bool[np.ndarray, "n h w"]) -> Float32[np.ndarray, "n h w"]:
    """Signed distance (px) of every pixel to the outline in its image, to MAX_DISTANCE_PX."""
    return np.stack([signed_distance(mask) for mask in masks])


def signed_distance(mask: Bool[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """Distance (px) to the outline, which runs half-way between unlike pixels."""
    half = np.float32(0.5)
    return np.where(mask, distance_to_mask(~mask) - half, half - distance_to_mask(mask))


def distance_to_mask(target: Bool[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """Distance (px) from every pixel's center to the nearest `target`, to MAX_DISTANCE_PX.

    Euclidean and exact, along the columns and then along the rows: squared distance separates
    -- Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled Functions" (2012).
    """
    column = np.where(target, np.uint8(0), np.uint8(MAX_DISTANCE_PX))
    for rows in (column, column[::-1]):
        for above, here in pairwise(rows):
            np.minimum(here, above + np.uint8(1), out=here)
    square = column * column
    best = square.copy()
    for step in range(1, MAX_DISTANCE_PX):
        shifted = square + np.uint8(step * step)
        np.minimum(best[:, step:], shifted[:, :-step], out=best[:, step:])
        np.minimum(best[:, :-step], shifted[:, step:], out=best[:, :-step])
    return np.sqrt(np.arange(256, dtype=np.float32))[best]
