"""The ground truth of one part: dense samples, their visibility, and the floors."""

from pathlib import Path

import numpy as np

from industnerf.artifacts.part import load_mesh
from industnerf.artifacts.truth import Truth
from industnerf.metrics.floors import measure_floors
from industnerf.metrics.reference_rig import ReferenceSurface
from industnerf.metrics.surface_samples import sample_reference
from industnerf.schema import EvaluateParams


def measure_truth(part: Path, target: Path, *, settings: EvaluateParams, seed: int) -> None:
    """Write samples of the part's surface, and the floor of every metric against them.

    Raises MetricError if the reference rig sees too few of them.
    """
    reference = ReferenceSurface(load_mesh(part))
    points, truth = sample_reference(part.name, reference, settings, seed, "scored")
    floors = measure_floors(part.name, reference, truth, settings, seed)
    Truth(points.astype(np.float32), truth.evaluated, floors).save(target)
