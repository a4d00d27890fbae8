"""Finishes of a part, and the light that all of them are seen in.

    brightness = albedo[finish] * (ambient + sum_k max(0, n . light_k))

A finish is what has one color in one light: pixels of like chromaticity, or whose brightness is
another multiple of the same function of the normal.  Points are told apart by the median of
their neighborhood, so that a wrong normal makes no finish.  A second finish must explain the
pictures clearly better than one.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int64
from pykdtree.kdtree import KDTree

from industnerf.methods.industnerf_plus.lighting import (
    OUTLIER_SCALE,
    Lighting,
    fit_lighting,
    refine_lighting,
)

NEIGHBORS = 24  # whose median tells a point's finish
CHROMA_WEIGHT = 4.0  # of log chromaticity, beside log brightness
MODE_RADIUS = 0.12  # of a finish, in weighted logarithms
MIN_SHARE = 0.02  # of the points that have a finish
MAX_FINISHES = 5
MAX_SPREAD = 0.1  # median deviation of log brightness within a finish
ROUNDS = 3
MAX_COST_RATIO = 0.8  # of the robust cost with several finishes to that with one
MIN_BRIGHTNESS = 0.02
MAX_RESIDUAL = 0.05  # of brightness in [0, 1]


@dataclass(frozen=True)
class FinishFit:
    """Light, and the finish of each of the points that it was fitted to."""

    lighting: Lighting
    albedo: Float[np.ndarray, "k"]  # of each finish, in units of the most frequent one
    label: Int64[np.ndarray, "n"]  # the finish of each point
    cost: float  # robust; of fits to the same points the smaller is better
    outlier_share: float  # of the points that are off by more than MAX_RESIDUAL


def fit_finishes(
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    rgb: Float[np.ndarray, "n 3"],
) -> FinishFit:
    """Light and finishes of points with known normals and colors in [0, 1]."""
    gray = rgb.mean(axis=1)
    single = best = evaluate(
        fit_lighting(normals, gray), np.ones(1), np.zeros(len(gray), np.int64), normals, gray
    )
    neighbors = KDTree(points).query(points, k=min(NEIGHBORS, len(points)))[1].astype(np.int64)
    color = np.maximum(rgb, MIN_BRIGHTNESS)
    chroma = CHROMA_WEIGHT * np.log(color[:, [0, 2]] / color[:, [1]])
    fit = single
    for number in range(ROUNDS):
        expected = np.maximum(fit.lighting.brightness(normals), MIN_BRIGHTNESS)
        ratio = np.log(np.maximum(gray, MIN_BRIGHTNESS) / expected)
        # at first the light is that of a wrong mixture of finishes, and colors alone tell
        features = np.column_stack([chroma, ratio if number else 0 * ratio])
        label = drop_uneven(cluster(np.median(features[neighbors], axis=1)), ratio)
        if number and np.array_equal(label, fit.label):
            break
        levels = median_by_label(label, ratio)
        albedo = np.exp(levels - levels[np.bincount(label).argmax()])
        lighting = fit_lighting(normals, gray / albedo[label], albedo[label] ** 2)
        fit = evaluate(lighting, albedo, label, normals, gray)
        if fit.cost < best.cost:
            best = fit
    return best if best.cost < MAX_COST_RATIO * single.cost else single


def refit_lighting(
    fit: FinishFit,
    label: Int64[np.ndarray, "n"],
    normals: Float[np.ndarray, "n 3"],
    rgb: Float[np.ndarray, "n 3"],
) -> FinishFit:
    """`fit` with its light refined by other points of known finish."""
    gray = rgb.mean(axis=1)
    lighting = refine_lighting(fit.lighting, normals, gray / fit.albedo[label])
    return evaluate(lighting, fit.albedo, label, normals, gray)


def evaluate(
    lighting: Lighting,
    albedo: Float[np.ndarray, "k"],
    label: Int64[np.ndarray, "n"],
    normals: Float[np.ndarray, "n 3"],
    gray: Float[np.ndarray, "n"],
) -> FinishFit:
    """The fit, with how well it explains the brightness of the points."""
    residual = np.abs(albedo[label] * lighting.brightness(normals) - gray)
    cost = float(np.log1p((residual / OUTLIER_SCALE) ** 2).mean())
    return FinishFit(lighting, albedo, label, cost, float((residual > MAX_RESIDUAL).mean()))


def drop_uneven(
    label: Int64[np.ndarray, "n"], ratio: Float[np.ndarray, "n"]
) -> Int64[np.ndarray, "n"]:
    """Labels without those whose brightness is no multiple of that of the light.

    So looks the filled mouth of a pocket, which has one normal and the colors of many.  Its points
    get the most frequent label.
    """
    spread = median_by_label(label, np.abs(ratio - median_by_label(label, ratio)[label]))
    kept = np.where((spread > MAX_SPREAD)[label], np.bincount(label).argmax(), label)
    return np.unique(kept, return_inverse=True)[1]


def median_by_label(
    label: Int64[np.ndarray, "n"], values: Float[np.ndarray, "n"]
) -> Float[np.ndarray, "k"]:
    """The median of each label, 0 of one that has no point."""
    own = [values[label == k] for k in range(label.max() + 1)]
    return np.array([np.median(each) if len(each) else 0.0 for each in own])


def cluster(features: Float[np.ndarray, "n d"]) -> Int64[np.ndarray, "n"]:
    """Labels by the strongest modes, one after the other."""
    remaining = np.ones(len(features), bool)
    centers = []
    while len(centers) < MAX_FINISHES and remaining.mean() > MIN_SHARE:
        left = features[remaining]
        trial = left[:: max(1, len(left) // 300)]
        distance = np.linalg.norm(trial[:, None] - left[None], axis=2)
        counts = (distance < MODE_RADIUS).sum(axis=1)
        center = np.median(left[distance[counts.argmax()] < MODE_RADIUS], axis=0)
        near = np.linalg.norm(features - center, axis=1) < 1.5 * MODE_RADIUS
        if (near & remaining).mean() < MIN_SHARE:
            break
        centers.append(center)
        remaining &= ~near
    if not centers:
        return np.zeros(len(features), np.int64)
    distance = np.linalg.norm(features[:, None] - np.array(centers)[None], axis=2)
    return distance.argmin(axis=1)
