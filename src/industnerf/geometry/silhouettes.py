"""Silhouettes from colour, and how far each pixel is from their outline."""

from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float, Float32, UInt8
from scipy.ndimage import minimum_filter, uniform_filter

MOST = 0.75  # of an image's border is no farther from the background than what is taken for noise
NOISE = 0.1  # in [0, 1]; what most of the border is off by, if more, is the part, cut by the frame
REACH = 2.5  # times that: Gaussian noise stays within, 4.2 sigma, or 3.3 where it is cut off at 1
ROUNDED = 0.003  # in [0, 1]; a colour in 8 bits is off by no more
LONE = 2.5  # of the nine pixels in a square: a wire has three of them, a speck seldom
NEAR = 11  # px; distances are exact up to here, and NEAR^2 + (NEAR - 1)^2 fits 8 bits
TOUCHED = 0.5  # px; a pixel that shows any of the part lies on average half outside it


def part_in(
    rgb: UInt8[np.ndarray, "n h w 3"], background: Float[np.ndarray, "n 3"], tolerance: float
) -> Bool[np.ndarray, "n h w"]:
    """The pixels that show the part: what differs from its view's background, in [0, 1].

    By more than `tolerance`, and by more than the background's noise, which the border of each
    image shows.  Where noise may pass the tolerance, faces nearly as bright as the background
    are told by the mean of nine pixels, and specks and pinholes are mended.
    """
    masks = []
    for picture, colour in zip(rgb, background, strict=True):
        noise = REACH * noise_of(picture, colour)
        mask = differs(picture[None], colour[None], max(tolerance, noise))[0]
        if 2 * noise > tolerance:
            mask = without_specks(mask | faint(picture, max(tolerance, noise / 3)))
        masks.append(mask)
    return np.stack(masks)


def noise_of(picture: UInt8[np.ndarray, "h w 3"], background: Float[np.ndarray, "3"]) -> float:
    """How far, in its worst channel, most of the border is from the background, in [0, 1]."""
    off = np.abs(border(picture) / 255 - background).max(axis=1)
    most = float(np.quantile(off, MOST))
    return most if ROUNDED < most < NOISE else 0.0


def border(picture: UInt8[np.ndarray, "h w 3"]) -> UInt8[np.ndarray, "_ 3"]:
    """The outermost pixels: the part is in frame, so they show the background."""
    return np.concatenate([picture[0], picture[-1], picture[1:-1, 0], picture[1:-1, -1]])


def faint(picture: UInt8[np.ndarray, "h w 3"], tolerance: float) -> Bool[np.ndarray, "h w"]:
    """Where all means of nine pixels about it, in [0, 1], differ from that of the border.

    The mean of nine has a third of the noise, and one that reaches over the outline does not
    count.  Noise before white is cut off, so its mean is darker than white: hence the border's.
    """
    means = uniform_filter(picture.astype(np.float32) / 255, (3, 3, 0), mode="nearest")
    off = np.abs(means - border(picture).mean(axis=0, dtype=np.float32) / 255).max(axis=2)
    return minimum_filter(off, 3, mode="nearest") > tolerance


def without_specks(mask: Bool[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Each pixel as all but two of the nine about it, where so many are alike."""
    alike = uniform_filter(np.float32(9) * mask, 3, mode="nearest")
    return (mask & (alike > LONE)) | (alike > 9 - LONE)


def differs(
    rgb: UInt8[np.ndarray, "n h w 3"], background: Float[np.ndarray, "n 3"], tolerance: float
) -> Bool[np.ndarray, "n h w"]:
    """Whether any channel is farther than `tolerance` from its view's background, in [0, 1]."""
    level = np.arange(256)[:, None] / 255
    masks = np.zeros(rgb.shape[:3], bool)
    for mask, picture, colour in zip(masks, rgb, background, strict=True):
        table = np.abs(level - colour) > tolerance
        for channel in range(3):
            mask |= table[picture[..., channel], channel]
    return masks


def outlines(masks: Bool[np.ndarray, "n h w"]) -> Float32[np.ndarray, "n h w"]:
    """Distance (px) of every pixel to the outline in its image, positive inside, to NEAR px."""
    return np.stack([signed_distance(mask) for mask in masks])


def signed_distance(mask: Bool[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """Distance (px) to the outline, which runs half-way between unlike pixels."""
    half = np.float32(0.5)
    return np.where(mask, to_nearest(~mask) - half, half - to_nearest(mask))


def to_nearest(target: Bool[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """Distance (px) from every pixel's centre to that of the nearest `target`, at most NEAR.

    Euclidean and exact, along the columns and then along the rows: squared distance separates
    -- Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled Functions" (2012).
    """
    column = np.where(target, np.uint8(0), np.uint8(NEAR))
    for downwards in (column, column[::-1]):
        for above, here in pairwise(downwards):
            np.minimum(here, above + np.uint8(1), out=here)
    square = column * column
    best = square.copy()
    for step in range(1, NEAR):
        aside = square + np.uint8(step * step)
        np.minimum(best[:, step:], aside[:, :-step], out=best[:, step:])
        np.minimum(best[:, :-step], aside[:, step:], out=best[:, :-step])
    return np.sqrt(np.arange(256, dtype=np.float32))[best]
