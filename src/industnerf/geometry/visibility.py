"""What a set of eyes can see of a solid."""

import numpy as np
from jaxtyping import Bool, Float

from industnerf.geometry.raycast import Scene


def seen_from(
    scene: Scene,
    points: Float[np.ndarray, "n 3"],
    eyes: Float[np.ndarray, "k 3"],
    tolerance_mm: float,
) -> Bool[np.ndarray, "n"]:
    """Whether each point is met by the line of sight of at least one eye.

    A point counts as met unless the surface is first met more than `tolerance_mm` before it:
    the tolerance lets points of the surface itself, and points slightly beneath it, be seen.
    """
    seen = np.zeros(len(points), bool)
    for eye in eyes:
        left = np.flatnonzero(~seen)
        if not len(left):
            break
        sight = points[left] - eye
        reach = np.linalg.norm(sight, axis=1)
        first = scene.distance(eye[None], sight / reach[:, None])
        seen[left] = first >= reach - tolerance_mm
    return seen
