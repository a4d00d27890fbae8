"""What a method sees from the held-out cameras, against their photographs.

P1-union  over the pixels that show the part in truth or in the rendering
P1-frame  over the whole frame

Colours are linear in [0, 1]; depth is z in the camera frame, in true bounding-box diagonals.  A
depth can be wrong only where both have one: its error is the mean over those pixels of the
union, and `coverage` stands beside it, the share of the true foreground that has a depth at all.
Over the whole frame the pixels count too where both agree that there is nothing, as right.
Every value is the mean over the held-out views; a view in which there is nothing to average
over does not count.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from statistics import fmean

import numpy as np
from jaxtyping import Bool, Float

from industnerf.metrics.ssim import ssim_map

ROUNDING = 1 / (12 * 255**2)  # mean squared error of colours rounded to 8 bits


@dataclass(frozen=True)
class Picture:
    """One view of a part."""

    rgb: Float[np.ndarray, "h w 3"]  # in [0, 1]
    depth: Float[np.ndarray, "h w"]  # diagonals; 0 is background
    foreground: Bool[np.ndarray, "h w"]


def mean_over_views(
    pairs: Iterable[tuple[Picture, Picture]],
) -> dict[tuple[str, str], float]:
    """(metric, protocol) -> its mean over the pairs of truth and rendering that have it."""
    found: dict[tuple[str, str], list[float]] = {}
    for truth, seen in pairs:
        for kind, value in of_view(truth, seen).items():
            found.setdefault(kind, []).append(value)
    return {kind: fmean(values) for kind, values in found.items()}


def of_view(truth: Picture, seen: Picture) -> dict[tuple[str, str], float]:
    """(metric, protocol) -> value in one view, without those that have no pixel to average."""
    union = truth.foreground | seen.foreground
    squares = ((truth.rgb - seen.rgb) ** 2).mean(axis=-1)
    alike = ssim_map(truth.rgb, seen.rgb)
    deep = (truth.depth > 0) & (seen.depth > 0)
    empty = (truth.depth == 0) & (seen.depth == 0)
    error = np.where(deep, (truth.depth - seen.depth) ** 2, 0)
    values = {("coverage", "P1-union"): _mean(seen.depth > 0, truth.foreground)}
    values["silhouette_iou", "P1-union"] = _mean(truth.foreground & seen.foreground, union)
    for protocol, where in (("P1-union", union), ("P1-frame", np.ones_like(union))):
        values["rgb_mse", protocol] = mse = _mean(squares, where)
        values["psnr", protocol] = None if mse is None else psnr(mse)
        values["ssim", protocol] = _mean(alike, where)
    values["depth_mse", "P1-union"] = _mean(error, deep & union)
    values["depth_mse", "P1-frame"] = _mean(error, deep | empty)
    return {kind: value for kind, value in values.items() if value is not None}


def psnr(mse: float) -> float:
    """Peak signal-to-noise ratio in dB of colours in [0, 1], -10 log10 of the squared error.

    Equal pictures are taken to differ by what rounding to 8 bits hides: 58.9 dB, not infinity.
    """
    return float(-10 * np.log10(max(mse, ROUNDING)))


def _mean(values: np.ndarray, where: Bool[np.ndarray, "h w"]) -> float | None:
    return float(values[where].mean()) if where.any() else None
