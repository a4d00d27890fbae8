"""Which points of a surface a set of cameras sees."""

import numpy as np
from jaxtyping import Bool, Float, Int

from industnerf.geometry.cameras import Cameras, project
from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.sampling import sample_surface
from industnerf.seeds import generator

NUM_SAMPLES = 4096  # of the surface, for a share of its area: a standard error below 0.8 %
RELATIVE_TOLERANCE = 1e-4  # how deep a sampled point may lie beneath the surface, in diagonals


def area_samples(
    vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]
) -> tuple[Float[np.ndarray, "samples 3"], float]:
    """The points by which all visible shares are measured, and the tolerance in mm for them.

    Always the same of a mesh, so that two shares differ by what is seen and not by chance.
    """
    points, _ = sample_surface(vertices, faces, NUM_SAMPLES, generator(0, "visible share"))
    return points, RELATIVE_TOLERANCE * float(np.linalg.norm(np.ptp(vertices, axis=0)))


def visible_from(
    scene: RaycastingScene,
    points: Float[np.ndarray, "n 3"],
    camera_centers: Float[np.ndarray, "k 3"],
    tolerance_mm: float,
) -> Bool[np.ndarray, "n"]:
    """Whether each point is met by the line of sight of at least one camera center.

    A point counts as met unless the surface is first met more than `tolerance_mm` before it:
    the tolerance lets points of the surface itself, and points slightly beneath it, be seen.
    """
    is_visible = np.zeros(len(points), bool)
    for camera_center in camera_centers:
        remaining = np.flatnonzero(~is_visible)
        if not len(remaining):
            break
        view_rays = points[remaining] - camera_center
        distance = np.linalg.norm(view_rays, axis=1)
        is_visible[remaining] = ~scene.is_occluded(
            camera_center[None], view_rays / distance[:, None], distance - tolerance_mm
        )
    return is_visible


def visible_in(
    scene: RaycastingScene, points: Float[np.ndarray, "n 3"], cameras: Cameras, tolerance_mm: float
) -> Bool[np.ndarray, "n"]:
    """As `visible_from` the centers of `cameras`, but only inside each camera's frame."""
    is_visible = np.zeros(len(points), bool)
    for K, c2w in zip(cameras.K, cameras.c2w, strict=True):
        remaining = np.flatnonzero(~is_visible)
        if not len(remaining):
            break
        uv, depth = project(points[remaining], K, c2w)
        in_frame = (depth > 0) & ((uv >= 0) & (uv <= [cameras.width, cameras.height])).all(axis=1)
        remaining = remaining[in_frame]
        is_visible[remaining] = visible_from(
            scene, points[remaining], c2w[None, :3, 3], tolerance_mm
        )
    return is_visible
