"""What a set of eyes can see of a solid."""

import numpy as np
from jaxtyping import Bool, Float, Int

from industnerf.geometry.cameras import Cameras, project
from industnerf.geometry.raycast import Scene
from industnerf.geometry.sampling import sample_surface
from industnerf.seeds import generator

SAMPLES = 4096  # of the surface, for a share of its area: a standard error below 0.8 %
TOLERANCE = 1e-4  # how deep a sampled point may lie beneath the surface, in diagonals


def area_samples(
    vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]
) -> tuple[Float[np.ndarray, "samples 3"], float]:
    """The points by which all visible shares are measured, and the tolerance in mm for them.

    Always the same of a mesh, so that two shares differ by what is seen and not by chance.
    """
    points, _ = sample_surface(vertices, faces, SAMPLES, generator(0, "visible share"))
    return points, TOLERANCE * float(np.linalg.norm(np.ptp(vertices, axis=0)))


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


def seen_by(
    scene: Scene, points: Float[np.ndarray, "n 3"], cameras: Cameras, tolerance_mm: float
) -> Bool[np.ndarray, "n"]:
    """As `seen_from` the eyes of `cameras`, where a point counts only inside a camera's frame."""
    seen = np.zeros(len(points), bool)
    for K, c2w in zip(cameras.K, cameras.c2w, strict=True):
        left = np.flatnonzero(~seen)
        if not len(left):
            break
        uv, depth = project(points[left], K, c2w)
        framed = (depth > 0) & ((uv >= 0) & (uv <= [cameras.width, cameras.height])).all(axis=1)
        left = left[framed]
        seen[left] = seen_from(scene, points[left], c2w[None, :3, 3], tolerance_mm)
    return seen
