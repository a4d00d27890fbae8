"""All metrics of protocol P1 between two sampled surfaces; bounding-box diagonal 1.

P1-even   both sides reduced by farthest points: geometry alone
P1-iid    the prediction reduced by random choice: geometry and density (paper, 4.3)
P1-full   as P1-even, but of the whole surface, hidden parts too
P1-dense  all samples of both sides
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from industnerf.metrics.chamfer import chamfer
from industnerf.metrics.emd import emd
from industnerf.metrics.fscore import fscore
from industnerf.metrics.gaps import between
from industnerf.metrics.inspection import inspected
from industnerf.metrics.reduce import farthest_points, random_points
from industnerf.metrics.values import Value
from industnerf.metrics.visible import Frame
from industnerf.schema import EvaluateParams


@dataclass(frozen=True)
class Sampled:
    """Points in diagonals, and which of them count against the visible surface."""

    points: Float[np.ndarray, "n 3"]
    kept: Bool[np.ndarray, "n"]


def compare(
    frame: Frame,
    truth: Sampled,
    predicted: Sampled,
    settings: EvaluateParams,
    rng: np.random.Generator,
) -> list[Value]:
    """Every metric of `predicted` against `truth`, samples of the surface of `frame`.

    Raises MetricError if a distance cannot be computed exactly.
    """
    n = settings.points
    shown = predicted.points[predicted.kept]
    visible = compare_visible(frame, truth, predicted, settings)
    if truth.kept.all() and predicted.kept.all():
        full = next(
            value.value for value in visible if (value.metric, value.protocol) == ("emd", "P1-even")
        )
    else:
        full = emd(farthest_points(truth.points, n), farthest_points(predicted.points, n))
    iid = emd(farthest_points(truth.points[truth.kept], n), random_points(shown, n, rng))
    return [
        *visible,
        Value("emd", "P1-iid", iid, "diagonal"),
        Value("emd", "P1-full", full, "diagonal"),
    ]


def compare_visible(
    frame: Frame, truth: Sampled, predicted: Sampled, settings: EvaluateParams
) -> list[Value]:
    """The metrics of the visible surface that no chance enters into: geometry alone."""
    n = settings.points
    seen, shown = truth.points[truth.kept], predicted.points[predicted.kept]
    even = emd(farthest_points(seen, n), farthest_points(shown, n))
    gaps = between(seen, shown)
    return [
        Value("emd", "P1-even", even, "diagonal"),
        Value("chamfer", "P1-dense", chamfer(gaps), "diagonal"),
        Value("fscore", "P1-dense", fscore(gaps, settings.fscore), "share", False),
        *inspected(frame, shown, gaps.truth, settings.tolerances_mm),
    ]
