"""The truth of one part: dense samples, what the reference rig sees of them, and the floors."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

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
    points, truth = surface_sample(part.name, frame, settings, seed, "scored")
    _, floor = surface_sample(part.name, frame, settings, seed, "floor")
    fewest = min(truth.kept.sum(), floor.kept.sum())
    if fewest < settings.points:
        raise MetricError(
            f"the reference rig sees only {fewest} of {settings.dense} samples, fewer than "
            f"evaluate.points = {settings.points}; raise evaluate.dense"
        )
    values = compare(frame, truth, floor, settings, generator(seed, "floor", part.name))
    floors = {f"{value.metric} {value.protocol}": value.value for value in values}
    Truth(points.astype(np.float32), truth.kept, floors).save(target)


def surface_sample(
    name: str, frame: Frame, settings: EvaluateParams, seed: int, use: str
) -> tuple[Float[np.ndarray, "n 3"], Sampled]:
    """Samples of the surface of the part `name`, in mm and in diagonals.

    `use` is `scored`, of the truth itself, or `floor`, of what a perfect method would return.
    """
    rng = generator(seed, "truth", use, name)
    points, _ = sample_surface(frame.mesh.vertices, frame.mesh.faces, settings.dense, rng)
    return points, Sampled(frame.unit(points), Rig(frame, settings).sees(points))
