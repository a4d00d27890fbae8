"""A block that no turn brings onto itself, and clouds of it."""

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from industnerf.deviation.registration import Similarity
from industnerf.geometry.sampling import sample_surface

GENERIC = Rotation.from_euler("xyz", [0.4, -1.1, 2.3]).as_matrix()
MOVE = Similarity(GENERIC, np.array([70.0, -30.0, 120.0]))


def box(size, corner):
    return trimesh.creation.box(bounds=[corner, np.add(corner, size)])


def mesh() -> trimesh.Trimesh:
    """60 x 40 x 20, with a step and a slot of its own at one end each."""
    cuts = [box((20, 40.0, 10), (40, 0, 10)), box((8, 10, 20.0), (0, 10, 0))]
    return trimesh.boolean.difference([box((60, 40, 20), (0, 0, 0)), *cuts])


def nearly_symmetric() -> trimesh.Trimesh:
    """60 x 40 x 10 with a notch in one corner, that takes half a per cent of its area."""
    return trimesh.boolean.difference([box((60, 40, 10), (0, 0, 0)), box((4, 4, 10), (0, 0, 0))])


def cloud(solid: trimesh.Trimesh, count: int = 8000, offset: float = 0.0) -> np.ndarray:
    """Points of its surface, moved outwards by `offset`."""
    points, face = sample_surface(
        np.array(solid.vertices), np.array(solid.faces), count, np.random.default_rng(0)
    )
    return points + offset * solid.face_normals[face]
