"""Protocol P1: from a cloud, or from its absence, to scores."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.part import load_mesh
from industnerf.artifacts.scores import Score, save_scores
from industnerf.artifacts.truth import Truth
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.shapes import ball_surface, box_surface
from industnerf.metrics.beyond import scores_beyond
from industnerf.metrics.compare import Sampled, Value, compare
from industnerf.metrics.reduce import random_points
from industnerf.metrics.visible import Frame, Rig, scored
from industnerf.schema import EvaluateParams
from industnerf.seeds import generator


def score_part(
    part: Path,
    truth: Path,
    views: Path,
    cloud: Path,
    target: Path,
    *,
    settings: EvaluateParams,
    seed: int,
) -> None:
    """Write the scores of the folder `cloud`; one with no point to score counts as failed.

    `views` are read only if the method returned more than a cloud.
    """
    known = Truth.load(truth)
    try:
        values = _against(part, known, Cloud.load(cloud).points_mm, settings, seed)
    except ReconstructionFailed:
        score_failure(part, truth, target, settings=settings, seed=seed)
    else:
        more = scores_beyond(Frame(load_mesh(part)), known, views, cloud)
        save_scores(target, [*(_score(value, known, "ok") for value in values), *more])


def score_failure(
    part: Path, truth: Path, target: Path, *, settings: EvaluateParams, seed: int
) -> None:
    """Write what a part without a cloud scores: the worse of its ball and its box."""
    known, frame = Truth.load(truth), Frame(load_mesh(part))
    extents, rng = np.ptp(frame.mesh.vertices, axis=0), generator(seed, "failure", part.name)
    ball, box = (
        _against(part, known, surface(extents, frame.centre, settings.cap, rng), settings, seed)
        for surface in (ball_surface, box_surface)
    )
    worse = [_worse(*pair) for pair in zip(ball, box, strict=True)]
    save_scores(target, [_score(value, known, "failed") for value in worse])


def _against(
    part: Path,
    known: Truth,
    points_mm: Float[np.ndarray, "n 3"],
    settings: EvaluateParams,
    seed: int,
) -> list[Value]:
    frame = Frame(load_mesh(part))
    rng = generator(seed, "evaluate", part.name)
    points_mm = random_points(points_mm.astype(np.float64), settings.cap, rng)
    truth_mm = known.points_mm.astype(np.float64)
    kept = scored(Rig(frame, settings), points_mm, truth_mm, known.visible, settings.hidden)
    if not kept.any():
        raise ReconstructionFailed("every point lies deep inside, nearest to hidden surface")
    truth = Sampled(frame.unit(truth_mm), known.visible)
    return compare(truth, Sampled(frame.unit(points_mm), kept), settings, rng)


def _worse(a: Value, b: Value) -> Value:
    return max(a, b, key=lambda value: value.value if value.smaller_is_better else -value.value)


def _score(value: Value, known: Truth, status: str) -> Score:
    floor = known.floors[f"{value.metric} {value.protocol}"]
    return Score(value.metric, value.protocol, value.value, floor, value.unit, status)
