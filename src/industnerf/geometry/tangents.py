"""Which points of a solid's surface its silhouettes can show."""

import numpy as np
from jaxtyping import Bool, Float

from industnerf.geometry.raycast import Scene

LINES = 89  # tried through each point, every 2 degrees of half a turn
STRIDE = 55  # Fibonacci's number before it: any first few lines are spread over the half turn


def on_visual_hull(
    scene: Scene,
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    depth_mm: float,
    rng: np.random.Generator,
) -> Bool[np.ndarray, "n"]:
    """Whether the hull of infinitely many silhouettes comes within `depth_mm` of each point.

    A place is cut off the hull iff some line through it misses the solid.  Tried are the places
    `depth_mm` before the surface, where `normals` (unit) point, and the lines parallel to the
    tangent plane, `LINES` of them from an angle chosen by `rng`: any other line turns towards the
    surface on one side.  A bore of radius R and length L is seen through from end to end if its
    axis lies within sqrt(2 R depth) / L of a line tried, so that only the slimmest are missed.
    """
    start = points + depth_mm * normals
    across, along = _tangents(normals)
    phase = rng.random((len(points), 1))
    shown = np.zeros(len(points), bool)
    for line in range(LINES):
        left = np.flatnonzero(~shown)
        angle = np.pi * (phase[left] + (line * STRIDE % LINES) / LINES)
        towards = np.cos(angle) * across[left] + np.sin(angle) * along[left]
        ahead = ~scene.blocked(start[left], towards)
        left, towards = left[ahead], towards[ahead]
        shown[left[~scene.blocked(start[left], -towards)]] = True
    return shown


def _tangents(
    normals: Float[np.ndarray, "n 3"],
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
    """Two unit vectors across each unit normal and across each other."""
    least = np.eye(3)[np.abs(normals).argmin(axis=1)]  # the axis furthest from the normal
    across = np.cross(normals, least)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return across, np.cross(normals, across)
