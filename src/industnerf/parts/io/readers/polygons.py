"""Polygons of four corners and more to triangles."""

import numpy as np
from jaxtyping import Float64, Int64


def triangulate_polygon(points: Float64[np.ndarray, "k 3"]) -> Int64[np.ndarray, "t 3"]:
    """Corners of the triangles that fill the polygon `points`, as indices into it.

    Convex ones are fanned; others have their ears clipped, in the plane of their area vector.
    """
    fan = np.array([(0, i, i + 1) for i in range(1, len(points) - 1)])
    flat = _project_to_plane(points)
    if flat is None or _is_convex(flat):
        return fan
    import manifold3d

    clipped = np.asarray(manifold3d.triangulate([flat]), np.int64).reshape(-1, 3)
    return clipped if len(clipped) == len(fan) else fan  # a polygon that crosses itself


def _project_to_plane(points: Float64[np.ndarray, "k 3"]) -> Float64[np.ndarray, "k 2"] | None:
    """The polygon as it runs counter-clockwise in its own plane; None if it has no area."""
    centered = points - points.mean(axis=0)
    area = np.cross(centered, np.roll(centered, -1, axis=0)).sum(axis=0)
    length = np.linalg.norm(area)
    if not np.isfinite(length) or length == 0:
        return None
    y, z = np.linalg.svd(area[None] / length)[2][1:]
    if np.dot(np.cross(y, z), area) < 0:
        y, z = z, y
    return centered @ np.stack([y, z], axis=1)


def _is_convex(flat: Float64[np.ndarray, "k 2"]) -> bool:
    """Whether every corner turns left, and the corners turn once around in all."""
    side = np.roll(flat, -1, axis=0) - flat
    following = np.roll(side, -1, axis=0)
    turn = side[:, 0] * following[:, 1] - side[:, 1] * following[:, 0]
    angle = np.arctan2(turn, (side * following).sum(axis=1))
    return bool((turn >= 0).all() and angle.sum() < 3 * np.pi)
