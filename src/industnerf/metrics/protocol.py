"""Protocol P1: from a cloud, or from its absence, to scores."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from statistics import fmean

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.cloud import Cloud, load_others
from industnerf.artifacts.part import load_mesh
from industnerf.artifacts.scores import Score, save_scores
from industnerf.artifacts.truth import Truth
from industnerf.geometry.shapes import ball_surface, box_surface
from industnerf.metrics.beyond import scores_beyond
from industnerf.metrics.compare import Sampled, compare, compare_visible
from industnerf.metrics.reduce import random_points
from industnerf.metrics.values import Value
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

    Where there are several answers, their mean: one without a point to score counts as much as a
    failure, and EMD `iid` and `full`, which cost most, are of the first answer alone.
    `views` are read only if the method returned more than a cloud.
    """
    judge = Judge(part, Truth.load(truth), settings, seed)
    answers = [Cloud.load(cloud).points_mm, *load_others(cloud)]
    found = [judge.judged(points, every=i == 0) for i, points in enumerate(answers)]
    if not any(found):
        score_failure(part, truth, target, settings=settings, seed=seed)
        return
    mean = _mean([some or judge.nothing(every=i == 0) for i, some in enumerate(found)])
    more = scores_beyond(judge.frame, judge.known, views, cloud)
    save_scores(target, [*(judge.score(value, "ok") for value in mean), *more])


def score_failure(
    part: Path, truth: Path, target: Path, *, settings: EvaluateParams, seed: int
) -> None:
    """Write what a part without a cloud scores: the worse of its ball and its box."""
    judge = Judge(part, Truth.load(truth), settings, seed)
    save_scores(target, [judge.score(value, "failed") for value in judge.nothing()])


@dataclass(frozen=True)
class Judge:
    """Measures clouds of one part."""

    part: Path
    known: Truth
    settings: EvaluateParams
    seed: int

    def judged(self, points_mm: Float[np.ndarray, "n 3"], *, every: bool = True) -> list[Value]:
        """The values of a cloud; none if no point of it can be scored.

        If not `every` metric, those of the visible surface that no chance enters into.
        """
        rng = generator(self.seed, "evaluate", self.part.name)
        shown = self.sampled(points_mm, rng)
        if shown is None:
            return []
        if every:
            return compare(self.frame, self.truth, shown, self.settings, rng)
        return compare_visible(self.frame, self.truth, shown, self.settings)

    @cached_property
    def frame(self) -> Frame:
        """Of the part's true surface."""
        return Frame(load_mesh(self.part))

    @cached_property
    def rig(self) -> Rig:
        """The reference rig round it."""
        return Rig(self.frame, self.settings)

    @cached_property
    def truth(self) -> Sampled:
        """The samples of the true surface."""
        points_mm = self.known.points_mm.astype(np.float64)
        return Sampled(self.frame.unit(points_mm), self.known.visible)

    def sampled(
        self, points_mm: Float[np.ndarray, "n 3"], rng: np.random.Generator
    ) -> Sampled | None:
        """A cloud, and which of its points count; None if none does."""
        points_mm = random_points(points_mm.astype(np.float64), self.settings.cap, rng)
        if not len(points_mm):
            return None
        truth_mm, visible = self.known.points_mm.astype(np.float64), self.known.visible
        kept = scored(self.rig, points_mm, truth_mm, visible, self.settings.hidden)
        if not kept.any():  # every point lies deep inside, nearest to hidden surface
            return None
        return Sampled(self.frame.unit(points_mm), kept)

    def nothing(self, *, every: bool = True) -> list[Value]:
        """What an absent cloud scores: the worse of the ball and the box, metric by metric."""
        frame = self.frame
        extents = np.ptp(frame.mesh.vertices, axis=0)
        rng = generator(self.seed, "failure", self.part.name)
        ball, box = (
            self.judged(surface(extents, frame.centre, self.settings.cap, rng), every=every)
            for surface in (ball_surface, box_surface)
        )
        return [_worse(*pair) for pair in zip(ball, box, strict=True)]

    def score(self, value: Value, status: str) -> Score:
        """`value` with its floor."""
        floor = self.known.floors[f"{value.metric} {value.protocol}"]
        return Score(value.metric, value.protocol, value.value, floor, value.unit, status)


def _mean(answers: list[list[Value]]) -> list[Value]:
    """Value by value of the first answer, the mean over all that have it."""
    named = [{(v.metric, v.protocol): v.value for v in values} for values in answers]
    return [
        replace(first, value=fmean(values[key] for values in named if key in values))
        for first in answers[0]
        for key in [(first.metric, first.protocol)]
    ]


def _worse(a: Value, b: Value) -> Value:
    return max(a, b, key=lambda value: value.value if value.smaller_is_better else -value.value)
