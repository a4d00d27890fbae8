"""The truth of one part: dense samples, what the reference rig sees of them, and the floors."""

from pathlib import Path

import numpy as np

from industnerf.artifacts.part import load_mesh
from industnerf.artifacts.truth import Truth
from industnerf.errors import MetricError
from industnerf.geometry.sampling import sample_surface
from industnerf.metrics.compare import Sampled, compare
from industnerf.metrics.visible import Frame, Rig
from industnerf.schema import EvaluateParams
from industnerf.seeds import generator


def measure_truth(part: Path, target: Path, *, settings: EvaluateParams, seed: int) -> None:
    """Sample the part twice, independently, and write the first sample and the floors.

    The floor of a metric is its value between the two: what a perfect method would score.
    """
    frame = Frame(load_mesh(part))
    rig = Rig(frame, settings)
    points, again = (
        sample_surface(frame.mesh.vertices, frame.mesh.faces, settings.dense, rng)[0]
        for rng in (generator(seed, "truth", use, part.name) for use in ("scored", "floor"))
    )
    truth, floor = (Sampled(frame.unit(p), rig.sees(p)) for p in (points, again))
    fewest = min(truth.kept.sum(), floor.kept.sum())
    if fewest < settings.points:
        raise MetricError(
            f"the reference rig sees only {fewest} of {settings.dense} samples, fewer than "
            f"evaluate.points = {settings.points}; raise evaluate.dense"
        )
    values = compare(frame, truth, floor, settings, generator(seed, "floor", part.name))
    floors = {f"{value.metric} {value.protocol}": value.value for value in values}
    Truth(points.astype(np.float32), truth.kept, floors).save(target)
