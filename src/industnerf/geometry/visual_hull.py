"""Which points of a solid's surface lie on its visual hull."""

import numpy as np
from jaxtyping import Bool, Float

from industnerf.geometry.raycast import RaycastingScene

NUM_LINES = 89  # tried through each point, every 2 degrees of half a turn
STRIDE = 55  # Fibonacci's number before it: any first few lines are spread over the half turn


def is_on_visual_hull(
    scene: RaycastingScene,
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    depth_mm: float,
    rng: np.random.Generator,
) -> Bool[np.ndarray, "n"]:
    """Whether the hull of infinitely many silhouettes comes within `depth_mm` of each point.

    A point is cut off the hull iff some line through it misses the solid.  Tried are the points
    `depth_mm` before the surface, where `normals` (unit) point, and the lines parallel to the
    tangent plane, NUM_LINES of them from an angle chosen by `rng`: any other line turns towards the
    surface on one side.  A bore of radius R and length L is seen through from end to end if its
    axis lies within sqrt(2 R depth) / L of a line tried, so that only the slimmest are missed.
    """
    start = points + depth_mm * normals
    across, along = _tangents(normals)
    phase = rng.random((len(points), 1))
    is_visible = np.zeros(len(points), bool)
    for line in range(NUM_LINES):
        remaining = np.flatnonzero(~is_visible)
        angle = np.pi * (phase[remaining] + (line * STRIDE % NUM_LINES) / NUM_LINES)
        direction = np.cos(angle) * across[remaining] + np.sin(angle) * along[remaining]
        is_free = ~scene.is_occluded(start[remaining], direction)
        remaining, direction = remaining[is_free], direction[is_free]
        is_visible[remaining[~scene.is_occluded(start[remaining], -direction)]] = True
    return is_visible


def _tangents(
    normals: Float[np.ndarray, "n 3"],
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
    """Two unit vectors across each unit normal and across each other."""
    helper_axis = np.eye(3)[np.abs(normals).argmin(axis=1)]  # the axis furthest from the normal
    across = np.cross(normals, helper_axis)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return across, np.cross(normals, across)
