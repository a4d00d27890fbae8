"""The mean of all parts learned from, whatever the pictures show.

What a net must beat to deserve its name -- Tatarchenko et al., "What Do Single-view 3D
Reconstruction Networks Learn?" (2019), section 3.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from industnerf.artifacts.state import State
from industnerf.geometry.isosurface import isosurface_points
from industnerf.methods.answers import answered
from industnerf.methods.base import Example, Given, Input, Method, Reconstruction, Role, Scope
from industnerf.schema import MeanShapeSettings


def fit(
    examples: Sequence[Example], settings: MeanShapeSettings, seed: int, scratch: Path
) -> State:
    """The share of parts that each voxel of the unit cube belongs to, and where to cut it."""
    from industnerf.learning.targets import voxels

    rng = np.random.default_rng(seed)
    solids = np.stack([voxels(*example.mesh, settings.grid_res, rng) for example in examples])
    mean = solids.mean(axis=0)
    return State(
        {"mean": mean.astype(np.float32), "level": np.float32(best_level(mean, solids))},
        parts=len(examples),
    )


def best_level(mean: Float[np.ndarray, "n n n"], solids: Bool[np.ndarray, "parts n n n"]) -> float:
    """Above which share a voxel is full: where the mean IoU with all parts is highest."""
    levels = np.unique(mean)
    levels = (levels[1:] + levels[:-1]) / 2 if len(levels) > 1 else levels - 0.5
    return float(max(levels, key=lambda level: mean_iou(mean > level, solids)))


def mean_iou(shape: Bool[np.ndarray, "n n n"], solids: Bool[np.ndarray, "parts n n n"]) -> float:
    """Mean over the parts of intersection over union with `shape`."""
    both = (solids & shape).sum(axis=(1, 2, 3))
    return float((both / (solids | shape).sum(axis=(1, 2, 3))).mean())


def reconstruct(
    given: Given, settings: MeanShapeSettings, state: State, seed: int
) -> Reconstruction:
    """Area-uniform points of the mean shape, at the part's place and scale."""
    mean, level = state.arrays["mean"], float(state.arrays["level"])
    size, rng = len(mean), np.random.default_rng(seed)
    lo = np.full(3, 0.5 / size - 0.5)
    points = isosurface_points(mean, level, lo, 1 / size, settings.points, rng)
    return answered([points], given.frame, state)


METHODS = {
    "mean_shape": Method(
        "mean_shape",
        Scope.DATASET,
        frozenset({Input.FRAME, Input.OTHER_MESHES}),
        reconstruct,
        fit,
        role=Role.NULL,
        random=True,
    )
}
