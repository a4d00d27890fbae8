"""The ground truth of one part: dense samples, their visibility, and the floors."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.part import load_mesh
from industnerf.artifacts.truth import Truth
from industnerf.errors import MetricError
from industnerf.geometry.sampling import sample_surface
from industnerf.metrics.compare import SampledSurface, compare
from industnerf.metrics.reference_rig import ReferenceRig, ReferenceSurface
from industnerf.schema import EvaluateParams
from industnerf.seeds import generator


def measure_truth(part: Path, target: Path, *, settings: EvaluateParams, seed: int) -> None:
    """Sample the part twice, independently, and write the first sample and the floors.

    The floor of a metric is its value between the two: what a perfect method would score.
    """
    reference = ReferenceSurface(load_mesh(part))
    points, truth = sample_reference(part.name, reference, settings, seed, "scored")
    _, floor = sample_reference(part.name, reference, settings, seed, "floor")
    num_visible = min(truth.evaluated.sum(), floor.evaluated.sum())
    if num_visible < settings.points:
        raise MetricError(
            f"the reference rig sees only {num_visible} of {settings.dense_samples} samples, fewer "
            f"than evaluate.points = {settings.points}; raise evaluate.dense_samples"
        )
    values = compare(reference, truth, floor, settings, generator(seed, "floor", part.name))
    floors = {f"{value.metric} {value.protocol}": value.value for value in values}
    Truth(points.astype(np.float32), truth.evaluated, floors).save(target)


def sample_reference(
    name: str, reference: ReferenceSurface, settings: EvaluateParams, seed: int, use: str
) -> tuple[Float[np.ndarray, "n 3"], SampledSurface]:
    """Samples of the surface of the part `name`, in mm and in diagonals.

    `use` is `scored`, of the truth itself, or `floor`, of what a perfect method would return.
    """
    rng = generator(seed, "truth", use, name)
    points, _ = sample_surface(
        reference.mesh.vertices, reference.mesh.faces, settings.dense_samples, rng
    )
    return points, SampledSurface(
        reference.normalize(points), ReferenceRig(reference, settings).is_visible(points)
    )
