"""Protocol P1: scores of a cloud, or of its absence."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from statistics import fmean

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.cloud import Cloud, load_extra_clouds
from industnerf.artifacts.part import load_mesh
from industnerf.artifacts.scores import Score, save_scores
from industnerf.artifacts.truth import Truth
from industnerf.geometry.sampling import ball_surface, box_surface
from industnerf.metrics.compare import MetricValue, compare, compare_visible
from industnerf.metrics.image_and_confidence_metrics import image_and_confidence_scores
from industnerf.metrics.reference_rig import ReferenceRig, ReferenceSurface, evaluated_mask
from industnerf.metrics.subsample import random_points
from industnerf.metrics.surface_samples import SampledSurface
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

    Of several predictions the mean: one without a point to score counts as much as a failure, and
    the EMD of P1-iid and P1-full, which cost most, are of the first prediction alone.
    `views` are read only if the method returned more than a cloud.
    """
    evaluator = Evaluator(part, Truth.load(truth), settings, seed)
    clouds = [Cloud.load(cloud).points_mm, *load_extra_clouds(cloud)]
    values = [evaluator.evaluate(points, all_metrics=i == 0) for i, points in enumerate(clouds)]
    if not any(values):
        score_failure(part, truth, target, settings=settings, seed=seed)
        return
    mean = _mean_values(
        [
            own_values or evaluator.failure_scores(all_metrics=i == 0)
            for i, own_values in enumerate(values)
        ]
    )
    extra_scores = image_and_confidence_scores(
        evaluator.reference, evaluator.ground_truth, views, cloud
    )
    save_scores(target, [*(evaluator.to_score(value, "ok") for value in mean), *extra_scores])


def score_failure(
    part: Path, truth: Path, target: Path, *, settings: EvaluateParams, seed: int
) -> None:
    """Write what a part without a cloud scores: the worse of its ball and its box."""
    evaluator = Evaluator(part, Truth.load(truth), settings, seed)
    save_scores(
        target, [evaluator.to_score(value, "failed") for value in evaluator.failure_scores()]
    )


@dataclass(frozen=True)
class Evaluator:
    """Measures clouds of one part."""

    part: Path
    ground_truth: Truth
    settings: EvaluateParams
    seed: int

    def evaluate(
        self, points_mm: Float[np.ndarray, "n 3"], *, all_metrics: bool = True
    ) -> list[MetricValue]:
        """The values of a cloud; none if no point of it can be scored.

        Without `all_metrics`, the deterministic ones of the visible surface.
        """
        rng = generator(self.seed, "evaluate", self.part.name)
        surface = self.sample_prediction(points_mm, rng)
        if surface is None:
            return []
        if all_metrics:
            return compare(self.reference, self.truth, surface, self.settings, rng)
        return compare_visible(self.reference, self.truth, surface, self.settings)

    @cached_property
    def reference(self) -> ReferenceSurface:
        """The part's true surface."""
        return ReferenceSurface(load_mesh(self.part))

    @cached_property
    def rig(self) -> ReferenceRig:
        """The reference rig around it."""
        return ReferenceRig(self.reference, self.settings)

    @cached_property
    def truth(self) -> SampledSurface:
        """The samples of the true surface."""
        points_mm = self.ground_truth.points_mm.astype(np.float64)
        return SampledSurface(self.reference.normalize(points_mm), self.ground_truth.visible)

    def sample_prediction(
        self, points_mm: Float[np.ndarray, "n 3"], rng: np.random.Generator
    ) -> SampledSurface | None:
        """A cloud in diagonals, and which of its points are compared; None if none is."""
        points_mm = random_points(points_mm.astype(np.float64), self.settings.max_points, rng)
        if not len(points_mm):
            return None
        truth_mm = self.ground_truth.points_mm.astype(np.float64)
        visible = self.ground_truth.visible
        evaluated = evaluated_mask(
            self.rig, points_mm, truth_mm, visible, self.settings.occlusion_margin
        )
        if not evaluated.any():  # every point lies deep inside, nearest to hidden surface
            return None
        return SampledSurface(self.reference.normalize(points_mm), evaluated)

    def failure_scores(self, *, all_metrics: bool = True) -> list[MetricValue]:
        """What an absent cloud scores: the worse of the ball and the box, metric by metric."""
        reference = self.reference
        extents = np.ptp(reference.mesh.vertices, axis=0)
        rng = generator(self.seed, "failure", self.part.name)
        ball, box = (
            self.evaluate(
                sample_shape(extents, reference.center, self.settings.max_points, rng),
                all_metrics=all_metrics,
            )
            for sample_shape in (ball_surface, box_surface)
        )
        return [_worse(*pair) for pair in zip(ball, box, strict=True)]

    def to_score(self, value: MetricValue, status: str) -> Score:
        """`value` with its floor."""
        floor = self.ground_truth.floors[f"{value.metric} {value.protocol}"]
        return Score(
            value.metric,
            value.protocol,
            value.value,
            floor.value,
            value.unit,
            status,
            floor.standard_error,
        )


def _mean_values(values_per_cloud: list[list[MetricValue]]) -> list[MetricValue]:
    """Value by value of the first prediction, the mean over all that have it."""
    by_metric = [{(v.metric, v.protocol): v.value for v in values} for values in values_per_cloud]
    return [
        replace(first, value=fmean(values[key] for values in by_metric if key in values))
        for first in values_per_cloud[0]
        for key in [(first.metric, first.protocol)]
    ]


def _worse(a: MetricValue, b: MetricValue) -> MetricValue:
    return max(a, b, key=lambda value: value.value if value.smaller_is_better else -value.value)
