"""Subsets of a cloud: farthest points, or random ones.

A cloud that already has few enough points is returned as it is: no point is ever duplicated.
"""

import fpsample
import numpy as np
from jaxtyping import Float, Int64

from industnerf.errors import MetricError
from industnerf.metrics.cloud_validation import validate_cloud

TREE_HEIGHT = 7  # of fpsample's k-d tree; 5 to 9 are about as fast at 65 536 points


def farthest_points(points: Float[np.ndarray, "n 3"], count: int) -> Float[np.ndarray, "m 3"]:
    """`count` evenly spread points: each next one is the farthest from all before.

    The first is fpsample's choice, the same in every run.
    """
    validated = validate_cloud(points, "points")
    if len(points) <= _require_positive(count):
        return points
    # fpsample computes in float32; about the centroid that keeps the most digits.
    centered = (validated - validated.mean(axis=0)).astype(np.float32)
    height = min(TREE_HEIGHT, len(points).bit_length() - 1)  # no more leaves than points
    # Not the point 0 of `points`, but of fpsample's tree: without it the start is random.
    indices = fpsample.bucket_fps_kdline_sampling(centered, count, h=height, start_idx=0)
    return points[_replace_duplicates(indices.astype(np.int64), len(points))]


def random_points(
    points: Float[np.ndarray, "n 3"], count: int, rng: np.random.Generator
) -> Float[np.ndarray, "m 3"]:
    """At most `count` of `points`, each subset equally likely, in their order."""
    if len(points) <= _require_positive(count):
        return points
    return points[np.sort(rng.choice(len(points), count, replace=False))]


def _replace_duplicates(indices: Int64[np.ndarray, "m"], n: int) -> Int64[np.ndarray, "m"]:
    """`indices`, and in place of repetitions others of the `n` points.

    fpsample repeats itself once every point left coincides with a chosen one.
    """
    if np.bincount(indices).max() == 1:
        return indices
    unique = indices[np.sort(np.unique(indices, return_index=True)[1])]
    spare = np.setdiff1d(np.arange(n), unique)[: len(indices) - len(unique)]
    return np.concatenate([unique, spare])


def _require_positive(count: int) -> int:
    if count < 1:
        raise MetricError(f"cannot reduce a cloud to {count} points; it takes at least 1")
    return count
