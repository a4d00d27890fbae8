"""The mean of all training parts, whatever the images show.

A baseline of networks -- Tatarchenko et al., "What Do Single-view 3D
Reconstruction Networks Learn?" (2019), section 3.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from industnerf.artifacts.state import ModelState
from industnerf.geometry.isosurface import isosurface_points
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
from industnerf.schema import MeanShapeSettings

NUM_SAMPLES = 1024  # points of each surface that levels are compared by


def fit(
    examples: Sequence[Example], settings: MeanShapeSettings, seed: int, scratch: Path
) -> ModelState:
    """The share of parts that each voxel of the unit cube belongs to, and where to cut it."""
    from industnerf.learning.targets import filled_shares, surface_points

    rng = np.random.default_rng(seed)
    meshes = [example.mesh for example in examples]
    mean = np.mean([filled_shares(*mesh, settings.grid_res) for mesh in meshes], axis=0) / 255
    surfaces = [surface_points(*mesh, NUM_SAMPLES, rng) for mesh in meshes]
    return ModelState(
        {"mean": mean.astype(np.float32), "level": np.float32(best_level(mean, surfaces, rng))},
        num_parts=len(examples),
    )


def best_level(
    mean: Float[np.ndarray, "n n n"],
    surfaces: Sequence[Float[np.ndarray, "p 3"]],
    rng: np.random.Generator,
) -> float:
    """Above which share a voxel is full: where the surface is nearest to all others in the mean.

    Not where solids overlap most: of slender parts that all lie otherwise little but a speck is
    common, and the tables measure surfaces.
    """
    shares = np.unique(mean)
    candidate_levels = (shares[1:] + shares[:-1]) / 2 if len(shares) > 1 else shares - 0.5

    def mean_distance(level: float) -> float:
        points = level_set_points(mean, level, NUM_SAMPLES, rng)
        return float(np.mean([chamfer(points, surface) for surface in surfaces]))

    return float(min(candidate_levels, key=mean_distance))


def chamfer(a: Float[np.ndarray, "n 3"], b: Float[np.ndarray, "m 3"]) -> float:
    """Mean distance to the nearest point of the other cloud, the sum of both ways."""
    return float(cKDTree(a).query(b)[0].mean() + cKDTree(b).query(a)[0].mean())


def level_set_points(
    mean: Float[np.ndarray, "n n n"], level: float, count: int, rng: np.random.Generator
) -> Float[np.ndarray, "_ 3"]:
    """Area-uniform points where the mean crosses `level`, in the unit cube."""
    size = len(mean)
    return isosurface_points(mean, level, np.full(3, 0.5 / size - 0.5), 1 / size, count, rng)


def reconstruct(
    inputs: MethodInputs, settings: MeanShapeSettings, state: ModelState, seed: int
) -> Reconstruction:
    """Area-uniform points of the mean shape, at the part's place and scale."""
    mean, level = state.arrays["mean"], float(state.arrays["level"])
    points = level_set_points(mean, level, settings.points, np.random.default_rng(seed))
    return predictions_to_reconstruction([points], inputs.part_frame, state)


METHODS = {
    "mean_shape": Method(
        "mean_shape",
        Scope.DATASET,
        frozenset({Input.PART_FRAME, Input.OTHER_MESHES}),
        reconstruct,
        fit,
        role=Role.NULL,
        is_stochastic=True,
    )
}
