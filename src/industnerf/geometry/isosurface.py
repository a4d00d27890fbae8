"""Marching cubes on a grid of values, and random points of the surface."""

import numpy as np
from jaxtyping import Float, Float32, Int32

from industnerf.geometry.sampling import sample_surface

MIN_ABS_DISTANCE = 0.01  # cells


def isosurface(
    values: Float[np.ndarray, "a b c"],
    level: float,
    lo: Float[np.ndarray, "3"],
    spacing: float,
) -> tuple[Float[np.ndarray, "n 3"], Int32[np.ndarray, "m 3"]]:
    """Vertices and faces where `values` cross `level`, in the unit of `spacing`; maybe none.

    `values[i, j, k]` is the value at `lo + spacing * (i, j, k)`; high is inside.  Outside of the
    grid all is far below the level, so that the surface is closed -- Lewiner et al. (2003).
    """
    from skimage.measure import marching_cubes

    if not (values > level).any():
        return np.zeros((0, 3)), np.zeros((0, 3), np.int32)
    lowest = level - (values.max() - level)  # the surface of a full grid is half a step outside
    closed = np.pad(values, 1, constant_values=lowest)
    vertices, faces, _, _ = marching_cubes(closed, level, gradient_direction="ascent")
    return lo + spacing * (vertices.astype(np.float64) - 1), faces.astype(np.int32)


def volume_matched_level(probabilities: Float[np.ndarray, "a b c"]) -> float:
    """The level above which lies as large a volume as the probabilities sum up to.

    At a fixed level a thin part that a network is unsure of vanishes, however sure it is of its
    volume.  Above this one there is always a cell, unless all are alike.
    """
    level = float(np.quantile(probabilities, 1 - probabilities.mean(dtype=np.float64)))
    highest = float(probabilities.max())
    lower = probabilities[probabilities < highest]
    # where many cells are the likeliest, the quantile may be theirs
    return min(level, (float(lower.max()) + highest) / 2) if len(lower) else level


def off_zero(cells: Float32[np.ndarray, "a b c"]) -> Float32[np.ndarray, "a b c"]:
    """Distances (cells) that are nowhere nearer to 0 than MIN_ABS_DISTANCE.

    Vertices nearer to a corner of the lattice are one in single precision.
    """
    is_near = np.abs(cells) < MIN_ABS_DISTANCE
    return np.where(is_near, np.float32(-MIN_ABS_DISTANCE), cells)


def isosurface_points(
    values: Float[np.ndarray, "a b c"],
    level: float,
    lo: Float[np.ndarray, "3"],
    spacing: float,
    count: int,
    rng: np.random.Generator,
) -> Float[np.ndarray, "_ 3"]:
    """`count` area-uniform points of `isosurface`; none where there is no surface."""
    vertices, faces = isosurface(values, level, lo, spacing)
    if not len(faces):
        return np.zeros((0, 3))
    return sample_surface(vertices, faces, count, rng)[0]
