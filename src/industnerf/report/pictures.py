"""Clouds as small pictures, seen by one of the part's own cameras."""

import numpy as np
from jaxtyping import Float, UInt8
from scipy.spatial import cKDTree

from industnerf.geometry.cameras import Cameras, project

PAPER = np.array([255, 255, 255], np.uint8)
SPLAT = 1  # a point covers (2 SPLAT + 1)^2 pixels


def nicest_view(cameras: Cameras) -> int:
    """The camera that looks from the upper right: where a draughtsman would stand."""
    centre = cameras.eyes.mean(axis=0)
    return int(np.argmax((cameras.eyes - centre) @ np.array([1.0, -1.2, 0.9])))


def splat(
    points_mm: Float[np.ndarray, "n 3"],
    colours: UInt8[np.ndarray, "n 3"],
    cameras: Cameras,
    view: int,
    size: int,
) -> UInt8[np.ndarray, "size size 3"]:
    """The points as the camera `view` would see them, nearest on top."""
    uv, depth = project(points_mm, cameras.K[view], cameras.c2w[view])
    order = np.argsort(-depth)  # far to near: later writes win
    pixel = np.floor(uv[order] * size / cameras.width).astype(int)
    picture = np.tile(PAPER, (size, size, 1))
    for down in range(-SPLAT, SPLAT + 1):
        for right in range(-SPLAT, SPLAT + 1):
            column, row = pixel[:, 0] + right, pixel[:, 1] + down
            inside = (column >= 0) & (column < size) & (row >= 0) & (row < size)
            picture[row[inside], column[inside]] = colours[order][inside]
    return picture


def distance_to(
    points_mm: Float[np.ndarray, "n 3"], truth_mm: Float[np.ndarray, "m 3"], diagonal_mm: float
) -> Float[np.ndarray, "n"]:
    """Distance of each point to the nearest sample of the truth, in diagonals."""
    return cKDTree(truth_mm).query(points_mm)[0] / diagonal_mm
