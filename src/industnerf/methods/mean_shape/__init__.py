"""The mean of all training parts, whatever the images show.

A baseline of networks -- Tatarchenko et al., "What Do Single-view 3D
Reconstruction Networks Learn?" (2019), section 3.  `mean_shape_procedural` is the mean of all
training parts and all procedural solids.
"""

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8
from scipy.spatial import cKDTree

from industnerf.artifacts.state import ModelState
from industnerf.geometry.isosurface import isosurface_points
from industnerf.learning.training_shape import NO_PRIOR, Prior, TrainingShape
from industnerf.methods.base import (
    Example,
    Input,
    Method,
    MethodInputs,
    Reconstruction,
    Role,
    Scope,
)
from industnerf.methods.multi_view_predictions import predictions_to_reconstruction
from industnerf.schema import MeanShapeSettings, SampleSettings

NUM_SAMPLES = 1024  # points of each surface that levels are compared by
MAX_COMPARED = 128  # surfaces at most, drawn at random
MAX_LEVELS = 64


def fit(
    examples: Sequence[Example], settings: MeanShapeSettings, seed: int, scratch: Path
) -> ModelState:
    """The share of parts that each voxel of the unit cube belongs to, and where to cut it."""
    voxels = (example.filled_shares(settings.grid_res) for example in examples)
    return _mean_state(examples, voxels, len(examples), seed)


def fit_procedural(
    examples: Sequence[Example],
    settings: SampleSettings,
    seed: int,
    scratch: Path,
    prior: Prior = NO_PRIOR,
) -> ModelState:
    """The same of all parts and procedural solids, in the voxels that solids have."""
    shapes: list[TrainingShape] = [*examples, *prior.solids]
    return _mean_state(shapes, (one.filled_shares() for one in shapes), len(examples), seed)


def _mean_state(
    shapes: Sequence[TrainingShape],
    voxels: Iterable[UInt8[np.ndarray, "n n n"]],
    num_parts: int,
    seed: int,
) -> ModelState:
    rng = np.random.default_rng(seed)
    mean = sum(one.astype(np.float64) for one in voxels) / (255 * len(shapes))
    compared = rng.choice(len(shapes), min(len(shapes), MAX_COMPARED), replace=False)
    surfaces = [shapes[i].surface_pool(rng)[:NUM_SAMPLES] for i in compared]
    arrays = {"mean": mean.astype(np.float32), "level": np.float32(best_level(mean, surfaces, rng))}
    return ModelState(arrays, num_parts=num_parts)


def best_level(
    mean: Float[np.ndarray, "n n n"],
    surfaces: Sequence[Float[np.ndarray, "p 3"]],
    rng: np.random.Generator,
) -> float:
    """Above which share a voxel is full: where the surface is nearest to all others in the mean.

    Not where solids overlap most: of slender parts that all lie otherwise little but a speck is
    common, and the tables measure surfaces.
    """
    trees = [cKDTree(surface) for surface in surfaces]

    def mean_distance(level: float) -> float:
        tree = cKDTree(level_set_points(mean, level, NUM_SAMPLES, rng))
        return float(np.mean([chamfer(tree, surface) for surface in trees]))

    return float(min(map(float, candidate_levels(mean)), key=mean_distance))


def candidate_levels(mean: Float[np.ndarray, "n n n"]) -> Float[np.ndarray, "levels"]:
    """Levels between all shares that occur; of too many MAX_LEVELS, as far apart by rank."""
    shares = np.unique(mean)
    levels = (shares[1:] + shares[:-1]) / 2 if len(shares) > 1 else shares - 0.5
    ranks = np.linspace(0, len(levels) - 1, min(len(levels), MAX_LEVELS))
    return levels[np.rint(ranks).astype(int)]


def chamfer(a: cKDTree, b: cKDTree) -> float:
    """Mean distance to the nearest point of the other cloud, the sum of both ways."""
    return float(a.query(b.data)[0].mean() + b.query(a.data)[0].mean())


def level_set_points(
    mean: Float[np.ndarray, "n n n"], level: float, count: int, rng: np.random.Generator
) -> Float[np.ndarray, "_ 3"]:
    """Area-uniform points where the mean crosses `level`, in the unit cube."""
    size = len(mean)
    return isosurface_points(mean, level, np.full(3, 0.5 / size - 0.5), 1 / size, count, rng)


def reconstruct(
    inputs: MethodInputs,
    settings: MeanShapeSettings | SampleSettings,
    state: ModelState,
    seed: int,
) -> Reconstruction:
    """Area-uniform points of the mean shape, at the part's place and scale."""
    mean, level = state.arrays["mean"], float(state.arrays["level"])
    points = level_set_points(mean, level, settings.points, np.random.default_rng(seed))
    return predictions_to_reconstruction([points], inputs.part_frame, state)


INPUTS = frozenset({Input.PART_FRAME, Input.OTHER_MESHES})
METHODS = {
    "mean_shape": Method(
        "mean_shape",
        Scope.DATASET,
        INPUTS,
        reconstruct,
        fit,
        role=Role.NULL,
        is_stochastic=True,
    ),
    "mean_shape_procedural": Method(
        "mean_shape_procedural",
        Scope.DATASET,
        INPUTS | {Input.PROCEDURAL_SOLIDS},
        reconstruct,
        fit_procedural,
        role=Role.NULL,
        is_stochastic=True,
    ),
}
