"""What makes a mesh a part: closed, outward oriented, of positive volume, clean from outside.

`vertices` are in mm; `faces` index them counter-clockwise seen from outside.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from industnerf.errors import BadPart
from industnerf.geometry.sphere import fibonacci_sphere

MOST_BACK_FACES = 1e-3  # share of the rays; a part with more crosses or folds through itself

FirstFace = Callable[
    [Float[np.ndarray, "rays 3"], Float[np.ndarray, "rays 3"]], Int[np.ndarray, "rays"]
]
"""The face that each ray (origin in mm, unit direction) meets first, -1 where it meets none."""


def bad_edges(faces: Int[np.ndarray, "m 3"]) -> Int[np.ndarray, "bad 2"]:
    """The edges, low index first, not shared by exactly two faces that run along it oppositely."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    n = int(faces.max(initial=0)) + 1
    low, high = np.minimum(start, end).astype(np.int64), np.maximum(start, end)
    edges, edge, count = np.unique(low * n + high, return_inverse=True, return_counts=True)
    forward = np.bincount(edge, weights=start < end, minlength=len(edges))
    wrong = edges[(count != 2) | (forward != 1)]
    return np.stack([wrong // n, wrong % n], axis=1)


def volume_mm3(vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> float:
    """Volume inside a closed mesh, negative if it is inside out.

    V = 1/6 sum a . (b x c): the divergence theorem, one tetrahedron per face.  The apex is put
    at the centre of the box, so that a part far from the origin loses no digits.
    """
    a, b, c = corners(vertices - (vertices.min(axis=0) + vertices.max(axis=0)) / 2, faces)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def area_mm2(vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> float:
    return float(np.linalg.norm(doubled_normals(vertices, faces), axis=1).sum() / 2)


def extents_mm(vertices: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "3"]:
    """Sides of the axis-aligned bounding box."""
    return np.ptp(vertices, axis=0)


def bodies(faces: Int[np.ndarray, "m 3"]) -> int:
    """Connected pieces of surface; faces are connected if they share a vertex."""
    vertex, inverse = np.unique(faces, return_inverse=True)
    a, b, c = inverse.reshape(-1, 3).T
    start, end = np.concatenate([a, b]), np.concatenate([b, c])
    shared = coo_array((np.ones(len(start)), (start, end)), shape=(len(vertex), len(vertex)))
    return int(connected_components(shared, directed=False, return_labels=False))


def back_face_share(
    vertices: Float[np.ndarray, "n 3"],
    faces: Int[np.ndarray, "m 3"],
    first_face: FirstFace,
    views: int = 64,
    rays_across: int = 64,
) -> float:
    """Of the rays from outside that hit the part, the share that meets a face from behind.

    Zero for a sound surface.  `views` parallel beams from all round, each a square grid of
    `rays_across`**2 rays as wide as the part.  Only such a test sees a solid that crosses itself:
    it can be closed, valid and of positive volume all the same.
    """
    centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    reach = 0.5 * float(np.linalg.norm(extents_mm(vertices)))
    normals = doubled_normals(vertices, faces)
    across = reach * (2 * np.arange(rays_across) + 1 - rays_across) / rays_across
    grid = np.stack(np.meshgrid(across, across), axis=-1).reshape(-1, 2)
    hit = behind = 0
    for direction in fibonacci_sphere(views):
        sides = np.linalg.svd(direction[None])[2][1:]  # two unit vectors across the beam
        origins = centre - 2 * reach * direction + grid @ sides
        face = first_face(origins, np.broadcast_to(direction, origins.shape))
        face = face[face >= 0]
        hit += len(face)
        behind += int((normals[face] @ direction > 0).sum())
    return behind / max(hit, 1)


def require_sound(
    part_id: str, vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]
) -> None:
    """Raise `BadPart` unless the mesh is closed, oriented and of positive volume."""
    wrong = bad_edges(faces)
    if len(wrong):
        x, y, z = vertices[wrong[0]].mean(axis=0)
        raise BadPart(
            f"part {part_id!r} is not closed: {len(wrong)} edges are not shared by exactly two "
            f"faces of one orientation, the first near ({x:.2f}, {y:.2f}, {z:.2f}) mm. "
            "Occupancy and volume are undefined on it."
        )
    volume = volume_mm3(vertices, faces)
    if not volume > 0:
        raise BadPart(f"part {part_id!r} is inside out: its volume is {volume:.4g} mm^3")


def corners(
    vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]
) -> tuple[Float[np.ndarray, "m 3"], Float[np.ndarray, "m 3"], Float[np.ndarray, "m 3"]]:
    return vertices[faces[:, 0]], vertices[faces[:, 1]], vertices[faces[:, 2]]


def doubled_normals(
    vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]
) -> Float[np.ndarray, "m 3"]:
    """Outward normals, each as long as twice its face's area (mm^2)."""
    a, b, c = corners(vertices, faces)
    return np.cross(b - a, c - a)
