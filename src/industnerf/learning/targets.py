"""Training targets from a mesh in the unit cube: surface points, voxels, occupancy."""

import numpy as np
from jaxtyping import Bool, Float, Float32, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.sampling import sample_surface

Vertices = Float[np.ndarray, "n 3"]
Faces = Int[np.ndarray, "m 3"]
# No edge of a CAD model runs along these, so that no ray grazes a face for long.
RAY_DIRECTIONS = np.array([[0.53, 0.61, 0.59], [-0.67, 0.29, 0.68], [0.31, -0.83, -0.46]])
RAY_DIRECTIONS /= np.linalg.norm(RAY_DIRECTIONS, axis=1, keepdims=True)
RAY_OFFSET = 1e-5  # of the unit cube: where a ray goes on behind a face
MAX_HITS = 512  # that a ray is followed through
SAMPLES_PER_VOXEL = 40  # of the surface for a square of the side of a voxel, were the area 1


def contains_points(
    vertices: Vertices, faces: Faces, points: Float[np.ndarray, "p 3"]
) -> Bool[np.ndarray, "p"]:
    """Whether each point is in the solid, by the winding number.

    It is counted along a ray: faces that the ray leaves through less those that it enters through,
    shell by shell, for where two touch a ray meets both their faces in one point.  Of each shell
    the median of three rays, so that one that slips through a gap is outvoted.
    """
    total = np.zeros(len(points), np.int64)
    for shell in connected_shells(faces):
        lo, hi = vertices[shell].min(axis=(0, 1)), vertices[shell].max(axis=(0, 1))
        in_box = np.flatnonzero(((points > lo) & (points < hi)).all(axis=1))
        scene = RaycastingScene(vertices, shell.astype(np.int32))
        normals = _normals(vertices, shell)
        votes = [
            _winding_number(scene, normals, points[in_box], direction)
            for direction in RAY_DIRECTIONS
        ]
        total[in_box] += np.median(votes, axis=0).astype(np.int64)
    return total > 0


def connected_shells(faces: Faces) -> list[Int[np.ndarray, "_ 3"]]:
    """The faces of each connected piece."""
    count = int(faces.max()) + 1
    edges = coo_array((np.ones(2 * len(faces)), (faces[:, :2].T.ravel(), faces[:, 1:].T.ravel())))
    edges.resize(count, count)
    label = connected_components(edges, directed=False)[1][faces[:, 0]]
    order = np.argsort(label, kind="stable")
    starts = np.flatnonzero(np.diff(label[order])) + 1
    return np.split(faces[order], starts)


def _winding_number(
    scene: RaycastingScene,
    normals: Float[np.ndarray, "m 3"],
    points: Float[np.ndarray, "p 3"],
    direction: Float[np.ndarray, "3"],
) -> Int[np.ndarray, "p"]:
    count = np.zeros(len(points), np.int64)
    active, origins = np.arange(len(points)), points.astype(np.float64)
    for _ in range(MAX_HITS):
        if not len(active):
            break
        hits = scene.cast(origins, np.broadcast_to(direction, origins.shape))
        is_hit = hits.face >= 0
        active = active[is_hit]
        count[active] += np.sign(normals[hits.face[is_hit]] @ direction).astype(np.int64)
        origins = origins[is_hit] + (hits.t[is_hit, None] + RAY_OFFSET) * direction
    return count


def _normals(vertices: Vertices, faces: Faces) -> Float[np.ndarray, "m 3"]:
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    return np.cross(b - a, c - a)


def voxelize(
    vertices: Vertices, faces: Faces, size: int, rng: np.random.Generator
) -> Bool[np.ndarray, "{size} {size} {size}"]:
    """The solid as `size`^3 voxels of the unit cube, as binvox makes them.

    A voxel is full if its center is inside, or if the surface passes through it: thin walls count.
    The latter is decided by points of the surface, SAMPLES_PER_VOXEL / area of them in the mean
    on a plane across a voxel: of an area of 8 one in 150 such voxels is missed.
    Voxel i spans [i, i + 1] / size - 1/2.
    """
    centers = (np.moveaxis(np.indices((size,) * 3), 0, -1).reshape(-1, 3) + 0.5) / size - 0.5
    occupied = contains_points(vertices, faces, centers).reshape((size,) * 3)
    surface, _ = sample_surface(vertices, faces, SAMPLES_PER_VOXEL * size * size, rng)
    occupied[tuple(((surface + 0.5) * size).astype(int).clip(0, size - 1).T)] = True
    return occupied


def surface_points(
    vertices: Vertices, faces: Faces, count: int, rng: np.random.Generator
) -> Float32[np.ndarray, "{count} 3"]:
    """Area-uniform points of the surface."""
    return sample_surface(vertices, faces, count, rng)[0].astype(np.float32)


def sample_occupancy(
    vertices: Vertices,
    faces: Faces,
    count: int,
    padding: float,
    rng: np.random.Generator,
) -> tuple[Float32[np.ndarray, "{count} 3"], Bool[np.ndarray, "{count}"]]:
    """Points that are uniform in the unit cube, enlarged by `padding`, and whether inside."""
    points = (rng.random((count, 3)) - 0.5) * (1 + padding)
    return points.astype(np.float32), contains_points(vertices, faces, points)
