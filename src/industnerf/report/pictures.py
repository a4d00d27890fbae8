"""From where a part is drawn, and how far its clouds are from the truth."""

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from industnerf.artifacts.part import Mesh
from industnerf.geometry.cameras import Cameras


def nicest_view(cameras: Cameras) -> int:
    """The camera that looks from the upper right: where a draughtsman would stand."""
    centre = cameras.eyes.mean(axis=0)
    return int(np.argmax((cameras.eyes - centre) @ np.array([1.0, -1.2, 0.9])))


def missed_by(
    truth_mm: Float[np.ndarray, "m 3"], points_mm: Float[np.ndarray, "n 3"], at_most_mm: float
) -> Float[np.ndarray, "m"]:
    """Distance (mm) of each sample of the truth to the nearest point, cut off at `at_most_mm`."""
    found, _ = cKDTree(points_mm).query(truth_mm, distance_upper_bound=at_most_mm)
    return np.minimum(found, at_most_mm)  # a search without result returns infinity


def deviation(points_mm: Float[np.ndarray, "n 3"], surface: Mesh) -> Float[np.ndarray, "n"]:
    """Distance (mm) of each point to the true surface itself."""
    # late: a report without a picture need not wait for Warp
    from industnerf.geometry.closest import distance_to_surface

    return distance_to_surface(points_mm, surface.vertices, surface.faces)
