"""From where a part is drawn, and how far its clouds are from the truth."""

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from industnerf.artifacts.part import Mesh
from industnerf.geometry.cameras import Cameras


def best_view(cameras: Cameras) -> int:
    """The camera that looks from the upper right: where a draughtsman would stand."""
    center = cameras.centers.mean(axis=0)
    return int(np.argmax((cameras.centers - center) @ np.array([1.0, -1.2, 0.9])))


def truth_to_cloud_distances(
    truth_mm: Float[np.ndarray, "m 3"], points_mm: Float[np.ndarray, "n 3"], max_mm: float
) -> Float[np.ndarray, "m"]:
    """Distance (mm) of each sample of the truth to the nearest point, cut off at `at_most_mm`."""
    distances, _ = cKDTree(points_mm).query(truth_mm, distance_upper_bound=max_mm)
    return np.minimum(distances, max_mm)  # a search without result returns infinity


def cloud_to_surface_distances(
    points_mm: Float[np.ndarray, "n 3"], surface: Mesh
) -> Float[np.ndarray, "n"]:
    """Distance (mm) of each point to the true surface itself."""
    # late: a report without a picture need not wait for Warp
    from industnerf.geometry.surface_distance import distance_to_surface

    return distance_to_surface(points_mm, surface.vertices, surface.faces)
