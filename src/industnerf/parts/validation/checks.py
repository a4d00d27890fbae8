"""What makes a mesh a part: closed, outward oriented, of positive volume, clean from outside.

`vertices` are in mm; `faces` index them counter-clockwise seen from outside.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float, Int

from industnerf.errors import BadPart
from industnerf.geometry.raycast import parallel_ray_bundles

MAX_BACK_FACE_SHARE = 1e-3  # share of the rays; a part with more crosses or folds through itself
VOLUME_TOLERANCE = 5e-3  # of the exact volume, or that of a finer mesh

FirstHit = Callable[
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
    bad = edges[(count != 2) | (forward != 1)]
    return np.stack([bad // n, bad % n], axis=1)


def volume_mm3(vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> float:
    """Volume inside a closed mesh, negative if it is inside out.

    V = 1/6 sum a . (b x c): the divergence theorem, one tetrahedron per face.  The apex is put
    at the center of the box, so that a part far from the origin loses no digits.
    """
    a, b, c = corners(vertices - (vertices.min(axis=0) + vertices.max(axis=0)) / 2, faces)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def area_mm2(vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> float:
    return float(np.linalg.norm(double_area_normals(vertices, faces), axis=1).sum() / 2)


def extents_mm(vertices: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "3"]:
    """Sides of the axis-aligned bounding box."""
    return np.ptp(vertices, axis=0)


def surface_components(faces: Int[np.ndarray, "m 3"]) -> Int[np.ndarray, "m"]:
    """The number of the connected piece of surface that each face is in, from 0.

    Faces are connected if they share a vertex.
    """
    from scipy.sparse import coo_array  # late: reading the catalogue needs numpy alone
    from scipy.sparse.csgraph import connected_components

    vertex, inverse = np.unique(faces, return_inverse=True)
    a, b, c = inverse.reshape(-1, 3).T
    start, end = np.concatenate([a, b]), np.concatenate([b, c])
    adjacency = coo_array((np.ones(len(start)), (start, end)), shape=(len(vertex), len(vertex)))
    return connected_components(adjacency, directed=False)[1][a]


def count_bodies(faces: Int[np.ndarray, "m 3"]) -> int:
    """Connected pieces of surface; the wall of a closed cavity is one of its own."""
    return int(surface_components(faces).max(initial=-1)) + 1


def count_solids(vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> int:
    """Pieces of surface; of a closed mesh only those of positive volume, for others are cavities.

    Counting so, a hollow ball is one solid and two bodies.
    """
    if len(bad_edges(faces)):
        return count_bodies(faces)
    a, b, c = corners(vertices - (vertices.min(axis=0) + vertices.max(axis=0)) / 2, faces)
    signed_volumes = np.einsum("ij,ij->i", a, np.cross(b, c))
    return int((np.bincount(surface_components(faces), weights=signed_volumes) > 0).sum())


def euler_number(faces: Int[np.ndarray, "m 3"]) -> int:
    """V - E + F, of the vertices that faces use; 2 (bodies - through holes) if closed."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    n = int(faces.max(initial=0)) + 1
    edges = np.sort(np.minimum(start, end).astype(np.int64) * n + np.maximum(start, end))
    num_edges = np.count_nonzero(np.diff(edges, prepend=-1))  # numpy's unique is slower
    return int(np.count_nonzero(np.bincount(start)) - num_edges + len(faces))


def through_holes(faces: Int[np.ndarray, "m 3"]) -> int:
    """The genus of a closed surface, summed over its pieces; 0 of an open one, which has none."""
    return 0 if len(bad_edges(faces)) else count_bodies(faces) - euler_number(faces) // 2


def back_face_share(
    vertices: Float[np.ndarray, "n 3"],
    faces: Int[np.ndarray, "m 3"],
    first_hit: FirstHit,
    views: int = 64,
    rays_per_side: int = 64,
) -> float:
    """Of the rays from outside that hit the part, the share that meets a face from behind.

    Zero for a sound surface.  The rays are `views` parallel beams of `rays_per_side`**2 from all
    around.  Only such a test sees a solid that crosses itself: it can be closed, valid and of
    positive volume all the same.
    """
    normals = double_area_normals(vertices, faces)
    num_hits = num_back = 0
    for origins, direction in parallel_ray_bundles(vertices, views, rays_per_side):
        face = first_hit(origins, np.broadcast_to(direction, origins.shape))
        face = face[face >= 0]
        num_hits += len(face)
        num_back += int((normals[face] @ direction > 0).sum())
    return num_back / max(num_hits, 1)


def require_watertight(
    part_id: str, vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]
) -> None:
    """Raise `BadPart` unless the mesh is closed, oriented and of positive volume."""
    bad = bad_edges(faces)
    if len(bad):
        x, y, z = vertices[bad[0]].mean(axis=0)
        raise BadPart(
            f"part {part_id!r} is not closed: {len(bad)} edges are not shared by exactly two "
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


def double_area_normals(
    vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]
) -> Float[np.ndarray, "m 3"]:
    """Outward normals, each as long as twice its face's area (mm^2)."""
    a, b, c = corners(vertices, faces)
    return np.cross(b - a, c - a)
