"""Scores of renderings and confidence; what a method does not return has no row.

A failed part has none either: an image that was never rendered has no error to invent.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from industnerf.artifacts.candidates import FILE, Candidates
from industnerf.artifacts.renderings import ARCHIVE, Renderings
from industnerf.artifacts.scores import Score
from industnerf.artifacts.truth import Truth
from industnerf.artifacts.views import ARCHIVE as PHOTOGRAPHS
from industnerf.artifacts.views import CAMERAS, Views, load_views
from industnerf.errors import MetricError
from industnerf.metrics.calibration import ause, random_ause, sparsification_at, spearman
from industnerf.metrics.images import NormalizedImage, mean_over_views, psnr
from industnerf.metrics.reference_rig import ReferenceSurface

MAX_CANDIDATE_DISTANCE = 0.05  # diagonals; only candidates this close to the visible truth count
REMOVED_PERCENTS = range(10, 100, 10)  # of the candidates, where sparsification is evaluated
# unit, and the best possible value: it stands where other metrics have their floor
METRICS = {
    "rgb_mse": ("white^2", 0.0),
    "psnr": ("dB", psnr(0.0)),
    "ssim": ("1", 1.0),
    "depth_mse": ("diagonal^2", 0.0),
    "coverage": ("share", 1.0),
    "silhouette_iou": ("share", 1.0),
    "confidence_spearman": ("1", -1.0),
    "confidence_ause": ("1", 0.0),
    "confidence_ause_chance": ("1", 0.0),
}


def image_and_confidence_files(views: Path, cloud: Path) -> tuple[Path, ...]:
    """The files that `image_and_confidence_scores` reads beside the part and its truth."""
    candidates = (cloud / FILE,) if (cloud / FILE).exists() else ()
    if not (cloud / ARCHIVE).exists():
        return candidates
    photographs = [views / PHOTOGRAPHS / name for name in (CAMERAS, "rgb", "mask", "depth")]
    return (*candidates, cloud / ARCHIVE, *photographs)


def image_and_confidence_scores(
    reference: ReferenceSurface, ground_truth: Truth, views: Path, cloud: Path
) -> list[Score]:
    """The scores of the renderings and of the candidates in the folder `cloud`, if it has them."""
    renderings, candidates = Renderings.load(cloud), Candidates.load(cloud)
    scores = []
    if renderings is not None:
        image_scores = mean_over_views(
            _image_pairs(load_views(views), renderings, reference.diagonal_mm)
        )
        scores += [_score(*kind, value) for kind, value in image_scores.items()]
    if candidates is not None:
        scores += _confidence_scores(reference, ground_truth, candidates)
    return scores


def _score(metric: str, protocol: str, value: float) -> Score:
    unit, best = METRICS[metric]
    return Score(metric, protocol, value, best, unit, "ok")


def _image_pairs(
    views: Views, renderings: Renderings, diagonal_mm: float
) -> Iterator[tuple[NormalizedImage, NormalizedImage]]:
    held_out = np.flatnonzero(views.held_out)
    if len(renderings) != len(held_out):
        raise MetricError(f"{len(renderings)} renderings of {len(held_out)} held-out views")
    for i, view in enumerate(held_out):
        (rgb,), (mask,) = views.rgb(view[None]), views.mask(view[None])
        (depth,) = views.depth_mm(view[None])
        yield (
            NormalizedImage(rgb / 255, depth / diagonal_mm, mask),
            NormalizedImage(
                renderings.rgb[i] / 255,
                renderings.depth_mm[i] / diagonal_mm,
                renderings.foreground[i],
            ),
        )


def _confidence_scores(
    reference: ReferenceSurface, ground_truth: Truth, candidates: Candidates
) -> list[Score]:
    """Confidence against the distance to the true surface, of the candidates near its visible part.

    Empty if fewer than two are near.
    """
    truth = reference.normalize(ground_truth.points_mm)
    points = reference.normalize(candidates.points_mm)
    to_visible, _ = cKDTree(truth[ground_truth.visible]).query(
        points, distance_upper_bound=MAX_CANDIDATE_DISTANCE
    )
    near = np.isfinite(to_visible)
    if near.sum() < 2:
        return []
    # hidden surface is surface: a point there is not wrong
    error = cKDTree(truth).query(points[near], distance_upper_bound=MAX_CANDIDATE_DISTANCE)[0]
    confidence = candidates.confidence[near].astype(np.float64)
    return [
        _score("confidence_spearman", "P1-near", spearman(confidence, error)),
        _score("confidence_ause", "P1-near", ause(error, confidence)),
        _score("confidence_ause_chance", "P1-near", random_ause(error)),
        *_sparsification_scores(error, confidence),
    ]


def _sparsification_scores(
    error: Float[np.ndarray, "n"], confidence: Float[np.ndarray, "n"]
) -> Iterator[Score]:
    """The curve by confidence; in the place of a floor, that by the true error."""
    shares = np.array(REMOVED_PERCENTS) / 100
    curves = (sparsification_at(error, order, shares) for order in (confidence, -error))
    for percent, remaining, best in zip(REMOVED_PERCENTS, *curves, strict=True):
        yield Score(f"error_left_{percent}", "P1-near", float(remaining), float(best), "1", "ok")
