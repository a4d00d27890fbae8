"""Plane faces of the surface, with the axes that most parts have squared up.

A soft surface tells a normal to some degrees.  Over the length of a bore that is cells, so each
plane is fitted to its nodes, and planes that nearly are at right angles are made so.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from industnerf.methods.industnerf_plus.distance_grid import band_nodes
from industnerf.methods.industnerf_plus.flat_regions import cosine, frequent_normals
from industnerf.methods.industnerf_plus.shaded_surface import ShadedSurface

SURFACE_NODES = 0.7  # cells from the surface
NORMAL_CONE_DEG = 18.0  # of the nodes that may be on a face
NEW_NORMAL_DEG = 10.0  # from all others
MIN_CROSS = 0.8  # length of the product of two normals that gives a third
BIN = 0.5  # cells of offset
MAX_OFFSETS = 5  # of one normal
MIN_NODES, MIN_SHARE = 60, 0.01  # of the nodes with that normal
FIT_TOLERANCES = (2.0, 1.2, 0.8)  # cells from the plane, one fit after the other
MIN_FITTED = 40
SAME_NORMAL_DEG, SAME_OFFSET = 2.0, 1.2  # degrees, cells; nearer faces are one
SQUARE_DEG = 2.5  # off a right angle, or less


@dataclass(frozen=True)
class Face:
    """normal . x = offset (cells), and the number of surface nodes that it was fitted to."""

    normal: Float[np.ndarray, "3"]
    offset: float
    num_nodes: int


def find_faces(surface: ShadedSurface, most: int) -> list[Face]:
    """At most so many faces of the surface, whose gradients are up to date; the largest first."""
    nodes = band_nodes(surface.distance.numpy(), SURFACE_NODES)
    normals = surface.normals(nodes.astype(float))
    points = nodes - normals * surface.distance.numpy()[tuple(nodes.T)][:, None]
    faces: list[Face] = []
    for normal in with_products(frequent_normals(normals)):
        for face in _of_normal(normal, points[normals @ normal > cosine(NORMAL_CONE_DEG)]):
            if not any(_is_same(face, other) for other in faces):
                faces.append(face)
    faces = sorted(faces, key=lambda face: -face.num_nodes)[:most]
    return square_up(faces, points)


def with_products(normals: Float[np.ndarray, "k 3"]) -> list[Float[np.ndarray, "3"]]:
    """The normals and the opposite ones, and those at right angles to two of them.

    The ends of a long profile are too small to be among the frequent ones.
    """
    found = list(normals)
    for i, a in enumerate(normals):
        for b in [a, *normals[:i]]:
            third = a if b is a else np.cross(a, b)
            length = np.linalg.norm(third)
            if length < MIN_CROSS:
                continue
            for normal in (third / length, -third / length):
                if all(normal @ other < cosine(NEW_NORMAL_DEG) for other in found):
                    found.append(normal)
    return found


def _of_normal(normal: Float[np.ndarray, "3"], points: Float[np.ndarray, "n 3"]) -> list[Face]:
    """Faces at the most frequent offsets, each fitted to its points."""
    if len(points) < MIN_NODES:
        return []
    offsets = points @ normal
    lowest = np.floor(offsets.min())
    counts = np.bincount(((offsets - lowest) / BIN).astype(int))
    counts = np.convolve(counts, np.ones(3, int), "same")
    faces = []
    for _ in range(MAX_OFFSETS):
        peak = int(counts.argmax())
        if counts[peak] < max(MIN_NODES, MIN_SHARE * len(points)):
            break
        face = _fit(normal, lowest + (peak + 0.5) * BIN, points)
        if face:
            faces.append(face)
        counts[max(0, peak - 4) : peak + 5] = 0
    return faces


def _fit(
    first: Float[np.ndarray, "3"], offset: float, points: Float[np.ndarray, "n 3"]
) -> Face | None:
    normal = first
    for tolerance in FIT_TOLERANCES:
        near = points[np.abs(points @ normal - offset) < tolerance]
        if len(near) < MIN_FITTED:
            return None
        mean = near.mean(axis=0)
        normal = np.linalg.svd(near - mean, full_matrices=False)[2][2]
        normal = normal * np.sign(normal @ first)
        offset = float(mean @ normal)
    is_same_cone = normal @ first > cosine(NORMAL_CONE_DEG)
    return Face(normal, offset, len(near)) if is_same_cone else None


def _is_same(a: Face, b: Face) -> bool:
    is_parallel = a.normal @ b.normal > cosine(SAME_NORMAL_DEG)
    return bool(is_parallel and abs(a.offset - b.offset) < SAME_OFFSET)


def square_up(faces: list[Face], points: Float[np.ndarray, "n 3"]) -> list[Face]:
    """Faces whose normals nearly are three axes at right angles get just these normals.

    The axes are the nearest rotation to the normals, weighted by their nodes (Kabsch, 1976).
    """
    frame = _first_frame(faces)
    if frame is None:
        return faces
    total = np.zeros((3, 3))
    for face in faces:
        axis, sign = _axis_of(face, frame)
        if sign:
            total[axis] += face.num_nodes * sign * face.normal
    left, _, right = np.linalg.svd(total)
    frame = left @ right
    squared = []
    for face in faces:
        axis, sign = _axis_of(face, frame)
        if sign:
            normal = sign * frame[axis]
            near = points[np.abs(points @ face.normal - face.offset) < 1]
            offset = float(np.median(near @ normal)) if len(near) else face.offset
            face = Face(normal, offset, face.num_nodes)
        squared.append(face)
    return squared


def _first_frame(faces: list[Face]) -> Float[np.ndarray, "3 3"] | None:
    """The normal of the first face, that of the next one at right angles, and their product."""
    if not faces:
        return None
    first = faces[0].normal
    for face in faces[1:]:
        if abs(face.normal @ first) < np.sin(np.radians(SQUARE_DEG)):
            second = face.normal - (face.normal @ first) * first
            second /= np.linalg.norm(second)
            return np.array([first, second, np.cross(first, second)])
    return None


def _axis_of(face: Face, frame: Float[np.ndarray, "3 3"]) -> tuple[int, float]:
    """The axis that is nearest to the normal, and its sign; 0: none is near."""
    along = frame @ face.normal
    axis = int(np.abs(along).argmax())
    return axis, float(np.sign(along[axis])) if abs(along[axis]) > cosine(SQUARE_DEG) else 0.0
