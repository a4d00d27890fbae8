"""Rotational symmetry of a surface, found from its moments and verified by rays.

Moments are of the area, so that open surfaces have them as well as solids: a rotation that takes
the surface to itself keeps its centroid and its moments of every degree.
"""

import numpy as np
from jaxtyping import Bool, Float, Int

from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.sphere import fibonacci_sphere

ORDERS = (3, 4, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37)  # higher primes are not tried
PROBE_RAYS = 32  # directions in which the surface is sought around a point
QUICK_CHECK_POINTS = 128  # points that a hopeless axis is judged by
MAX_MISS_SHARE = 0.1  # of them; if 1 % miss in truth, 13 or more of 128 do so once in 10^9
SEARCH_DIRECTIONS = 4096  # directions tried for the extremes of the fourth moment
# Points of a triangle and weights, exact to degree 4 -- Dunavant (1985), table II, p = 4
QUADRATURE_NODES = ((0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322))


def rotation_order(
    vertices: Float[np.ndarray, "n 3"],
    faces: Int[np.ndarray, "m 3"],
    scene: RaycastingScene,
    points: Float[np.ndarray, "k 3"],
    tolerance_mm: float,
    min_share: float,
) -> int | None:
    """The least order in `ORDERS` of a rotational symmetry of the surface, or None.

    Every symmetry of order 3 or more holds one of order 4 or of an odd prime order.  The axis
    runs through the centroid.  Tried are the principal axes of inertia, and, because inertia
    tells a cube's axes no better than a ball's, the directions in which the fourth moment is
    greatest and least: among them are a cube's, and any a ball's.  They are not a dodecahedron's,
    whose fourth moment is a ball's too.

    An axis passes if each rotation of the order takes at least `min_share` of `points` (of the
    surface) to within `tolerance_mm` of it; one alone would let a helix pass, which a small turn
    shifts by little.  Where the points lie within 2 `tolerance_mm` of the axis, in the mean
    square, nothing is told from anything, and it does not pass.
    """
    nodes, weights = _quadrature(vertices, faces)
    centroid = weights @ nodes
    from_center, nodes = points - centroid, nodes - centroid
    axes = np.concatenate([_principal_axes(nodes, weights), _quartic_extremes(nodes, weights)])
    axis_distance = np.linalg.norm(np.cross(from_center[:, None], axes), axis=2)
    candidate_axes = axes[np.sqrt((axis_distance**2).mean(axis=0)) > 2 * tolerance_mm]
    for order in ORDERS:
        for axis in candidate_axes:
            rotations = (
                _rotation_matrix(axis, 2 * np.pi * i / order) for i in range(1, order // 2 + 1)
            )
            rotated_points = (centroid + from_center @ rotation.T for rotation in rotations)
            if all(
                _is_on_surface(scene, rotated, tolerance_mm, min_share)
                for rotated in rotated_points
            ):
                return order
    return None


def _is_on_surface(
    scene: RaycastingScene, points: Float[np.ndarray, "k 3"], tolerance_mm: float, min_share: float
) -> bool:
    quick_share = is_near_surface(scene, points[:QUICK_CHECK_POINTS], tolerance_mm).mean()
    if quick_share < 1 - MAX_MISS_SHARE:
        return False
    return bool(is_near_surface(scene, points, tolerance_mm).mean() >= min_share)


def is_near_surface(
    scene: RaycastingScene, points: Float[np.ndarray, "k 3"], max_distance_mm: float
) -> Bool[np.ndarray, "k"]:
    """Whether any of PROBE_RAYS rays from each point meets the surface within `max_distance_mm`.

    They are spread evenly: a plane nearer than 0.88 of that distance is always met.
    """
    is_near = np.zeros(len(points), bool)
    for direction in fibonacci_sphere(PROBE_RAYS):
        remaining = np.flatnonzero(~is_near)
        directions = np.broadcast_to(direction, (len(remaining), 3))
        is_near[remaining] = scene.is_occluded(points[remaining], directions, max_distance_mm)
    return is_near


def _quadrature(
    vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]
) -> tuple[Float[np.ndarray, "nodes 3"], Float[np.ndarray, "nodes"]]:
    """Points and weights, summing to 1, that integrate polynomials of degree 4 over the area."""
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(*(corners[:, 1:] - corners[:, :1]).swapaxes(0, 1)), axis=1)
    nodes, weights = [], []
    for share, weight in QUADRATURE_NODES:
        for corner in range(3):
            barycentric = np.full(3, share)
            barycentric[corner] = 1 - 2 * share
            nodes.append(barycentric @ corners)
            weights.append(weight * area / area.sum())
    return np.concatenate(nodes), np.concatenate(weights)


def _principal_axes(
    nodes: Float[np.ndarray, "nodes 3"], weights: Float[np.ndarray, "nodes"]
) -> Float[np.ndarray, "3 3"]:
    return np.linalg.eigh((nodes * weights[:, None]).T @ nodes)[1].T


def _quartic_extremes(
    nodes: Float[np.ndarray, "nodes 3"], weights: Float[np.ndarray, "nodes"]
) -> Float[np.ndarray, "2 3"]:
    """The directions u in which the sum of weight (x . u)^4 is greatest and least."""
    squares = np.einsum("ni,nj->nij", nodes, nodes).reshape(-1, 9)
    fourth = (squares * weights[:, None]).T @ squares
    extremes = []
    for sign in (1, -1):
        directions, spread = fibonacci_sphere(SEARCH_DIRECTIONS), 1.0
        for _ in range(4):  # each round looks closer: steps of 3, 0.6, 0.07, 0.01 degrees
            pairs = np.einsum("ni,nj->nij", directions, directions).reshape(-1, 9)
            best = directions[np.argmax(sign * np.einsum("ni,ij,nj->n", pairs, fourth, pairs))]
            spread /= 8
            directions = best + spread * fibonacci_sphere(SEARCH_DIRECTIONS // 4)
            directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        extremes.append(best)
    return np.array(extremes)


def _rotation_matrix(axis: Float[np.ndarray, "3"], angle: float) -> Float[np.ndarray, "3 3"]:
    """The rotation by `angle` about the unit vector `axis` -- Rodrigues (1840)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
