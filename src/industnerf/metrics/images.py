"""A method's renderings from the held-out cameras, against their photographs.

P1-union  over the pixels that show the part in truth or in the rendering
P1-frame  over the whole frame

Colors are linear in [0, 1]; depth is z in the camera frame, in true bounding-box diagonals.  A
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

QUANTIZATION_MSE = 1 / (12 * 255**2)  # mean squared error of colors rounded to 8 bits


@dataclass(frozen=True)
class NormalizedImage:
    """One view of a part."""

    rgb: Float[np.ndarray, "h w 3"]  # in [0, 1]
    depth: Float[np.ndarray, "h w"]  # diagonals; 0 is background
    foreground: Bool[np.ndarray, "h w"]


def mean_over_views(
    pairs: Iterable[tuple[NormalizedImage, NormalizedImage]],
) -> dict[tuple[str, str], float]:
    """(metric, protocol) -> its mean over the pairs of truth and rendering that have it."""
    values_by_metric: dict[tuple[str, str], list[float]] = {}
    for truth, rendered in pairs:
        for kind, value in view_scores(truth, rendered).items():
            values_by_metric.setdefault(kind, []).append(value)
    return {kind: fmean(values) for kind, values in values_by_metric.items()}


def view_scores(truth: NormalizedImage, rendered: NormalizedImage) -> dict[tuple[str, str], float]:
    """(metric, protocol) -> value in one view, without those that have no pixel to average."""
    union = truth.foreground | rendered.foreground
    squares = ((truth.rgb - rendered.rgb) ** 2).mean(axis=-1)
    similarity = ssim_map(truth.rgb, rendered.rgb)
    both_have_depth = (truth.depth > 0) & (rendered.depth > 0)
    both_empty = (truth.depth == 0) & (rendered.depth == 0)
    error = np.where(both_have_depth, (truth.depth - rendered.depth) ** 2, 0)
    values = {("coverage", "P1-union"): _masked_mean(rendered.depth > 0, truth.foreground)}
    values["silhouette_iou", "P1-union"] = _masked_mean(
        truth.foreground & rendered.foreground, union
    )
    for protocol, region in (("P1-union", union), ("P1-frame", np.ones_like(union))):
        values["rgb_mse", protocol] = mse = _masked_mean(squares, region)
        values["psnr", protocol] = None if mse is None else psnr(mse)
        values["ssim", protocol] = _masked_mean(similarity, region)
    values["depth_mse", "P1-union"] = _masked_mean(error, both_have_depth & union)
    values["depth_mse", "P1-frame"] = _masked_mean(error, both_have_depth | both_empty)
    return {kind: value for kind, value in values.items() if value is not None}


def psnr(mse: float) -> float:
    """Peak signal-to-noise ratio in dB of colors in [0, 1], -10 log10 of the squared error.

    Equal images are taken to differ by what rounding to 8 bits hides: 58.9 dB, not infinity.
    """
    return float(-10 * np.log10(max(mse, QUANTIZATION_MSE)))


def _masked_mean(values: np.ndarray, mask: Bool[np.ndarray, "h w"]) -> float | None:
    return float(values[mask].mean()) if mask.any() else None
