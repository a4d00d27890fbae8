"""Training targets from a mesh in the unit cube: surface points, voxels, occupancy."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float16, Float32, Int, UInt8
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.sampling import sample_surface

Vertices = Float[np.ndarray, "n 3"]
Faces = Int[np.ndarray, "m 3"]
# No edge of a CAD model runs along these, so that no ray grazes a face for long.
RAY_DIRECTIONS = np.array([[0.53, 0.61, 0.59], [-0.67, 0.29, 0.68], [0.31, -0.83, -0.46]])
RAY_DIRECTIONS /= np.linalg.norm(RAY_DIRECTIONS, axis=1, keepdims=True)
RAY_OFFSET = 1e-5  # of the unit cube: where a ray goes on behind a face
MAX_HITS = 512  # that a ray is followed through
VOXELS = 32  # a side of the grids that networks learn
SUBDIVISIONS = 2  # of a voxel along each axis, where it is asked how much of it is solid
SURFACE_POOL = 4096  # points of a surface that every step draws its few from
PADDING = 0.1  # by which the cube of occupancy points is larger than the unit cube, as published
NEAR = 0.03  # points of space as close as this to the surface are near it
POOL_OVERSAMPLING = 4  # uniform points for every one that is kept
NEARNESS_SAMPLES = 16384  # of the surface, from which distances to it are taken


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
        total[in_box] += _median_of_three(*votes)
    return total > 0


def _median_of_three(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    return np.maximum(np.minimum(a, b), np.minimum(np.maximum(a, b), c))


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


def surface_points(
    vertices: Vertices, faces: Faces, count: int, rng: np.random.Generator
) -> Float32[np.ndarray, "{count} 3"]:
    """Area-uniform points of the surface."""
    return sample_surface(vertices, faces, count, rng)[0].astype(np.float32)


def filled_shares(
    vertices: Vertices, faces: Faces, size: int
) -> UInt8[np.ndarray, "{size} {size} {size}"]:
    """How much of each of `size`^3 voxels of the unit cube is solid; 255 is all of it.

    It is counted at SUBDIVISIONS^3 points of the voxel.  Voxel i spans [i, i + 1] / size - 1/2.
    """
    fine = occupancy_grid(vertices, faces, SUBDIVISIONS * size)
    blocks = fine.reshape(3 * (size, SUBDIVISIONS))
    return np.rint(255 * blocks.mean(axis=(1, 3, 5))).astype(np.uint8)


def occupancy_grid(
    vertices: Vertices, faces: Faces, size: int
) -> Bool[np.ndarray, "{size} {size} {size}"]:
    """Whether the centers of `size`^3 cells of the unit cube are in the solid.

    As `contains_points`, but with one ray for a whole column of cells, and so for each axis.
    """
    total = np.zeros((size,) * 3, np.int64)
    for shell in connected_shells(faces):
        scene = RaycastingScene(vertices, shell.astype(np.int32))
        normals = _normals(vertices, shell)
        votes = [_column_winding(scene, normals, size, axis) for axis in range(3)]
        total += _median_of_three(*votes)
    return total > 0


def _column_winding(
    scene: RaycastingScene, normals: Float[np.ndarray, "m 3"], size: int, axis: int
) -> Int[np.ndarray, "n n n"]:
    """Winding numbers of all cells, along `axis`: faces entered through less those left through."""
    across = (np.arange(size) + 0.5) / size - 0.5
    # off the cells' centers, where edges of CAD models like to be
    u, v = (grid.ravel() for grid in np.meshgrid(across + 7e-6, across + 4e-6, indexing="ij"))
    origins = np.insert(np.stack([u, v], axis=1), axis, -0.6, axis=1)
    direction = np.eye(3)[axis]
    changes, active = np.zeros((size * size, size + 1), np.int64), np.arange(size * size)
    for _ in range(MAX_HITS):
        if not len(active):
            break
        hits = scene.cast(origins, np.broadcast_to(direction, origins.shape))
        is_hit = hits.face >= 0
        active, origins = active[is_hit], origins[is_hit] + hits.t[is_hit, None] * direction
        first_cell_behind = np.ceil((origins[:, axis] + 0.5) * size - 0.5).clip(0, size)
        np.subtract.at(
            changes,
            (active, first_cell_behind.astype(int)),
            np.sign(normals[hits.face[is_hit], axis]).astype(np.int64),
        )
        origins += RAY_OFFSET * direction
    return np.moveaxis(changes.cumsum(axis=1)[:, :size].reshape((size,) * 3), 2, axis)


@dataclass(frozen=True)
class OccupancyPool:
    """Points of the padded unit cube with known occupancy, of three strata.

    Half of them are inside, a quarter outside but near the surface, a quarter farther off.  Thin
    parts fill less than 3 % of the cube: of 256 uniform points hardly one would be inside.
    `shares` has the stratum's share of the cube's volume, by which a loss stays unbiased.
    """

    points: Float16[np.ndarray, "n 3"]  # stratum by stratum
    shares: Float32[np.ndarray, "3"]

    def draw(
        self, count: int, rng: np.random.Generator
    ) -> tuple[
        Float32[np.ndarray, "{count} 3"],
        Bool[np.ndarray, "{count}"],
        Float32[np.ndarray, "{count}"],
    ]:
        """`count` random points, stratum by stratum, whether inside, and weights of mean 1."""
        sizes, counts = stratum_sizes(len(self.points)), stratum_sizes(count)
        strata = zip(np.cumsum((0, *sizes[:2])), sizes, counts, strict=True)
        indices = np.concatenate(
            [start + rng.integers(size, size=drawn) for start, size, drawn in strata]
        )
        weights = np.repeat(self.shares * np.float32(count) / np.array(counts, np.float32), counts)
        return self.points[indices].astype(np.float32), indices < sizes[0], weights


def stratum_sizes(count: int) -> tuple[int, int, int]:
    """How many of `count` points each stratum has."""
    return count - 2 * (count // 4), count // 4, count // 4


def sample_occupancy(
    vertices: Vertices, faces: Faces, count: int, rng: np.random.Generator
) -> OccupancyPool:
    """A pool of `count` points, chosen from POOL_OVERSAMPLING times as many uniform ones."""
    points = (rng.random((POOL_OVERSAMPLING * count, 3)) - 0.5) * (1 + PADDING)
    inside = contains_points(vertices, faces, points)
    surface = cKDTree(sample_surface(vertices, faces, NEARNESS_SAMPLES, rng)[0])
    is_near = np.isfinite(surface.query(points, distance_upper_bound=NEAR)[0])
    strata = [np.flatnonzero(s) for s in (inside, ~inside & is_near, ~inside & ~is_near)]
    chosen = [
        points[rng.choice(stratum, size)] if len(stratum) else np.zeros((size, 3))
        for stratum, size in zip(strata, stratum_sizes(count), strict=True)
    ]
    shares = np.array([len(stratum) for stratum in strata], np.float32) / len(points)
    return OccupancyPool(np.concatenate(chosen).astype(np.float16), shares)
