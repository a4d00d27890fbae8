"""Move a cloud onto a surface: a search over all rotations, then iterative closest points.

The search needs no start: it tries thousands of rotations about the centroids on a grid of
distances, refines the best, and keeps the one whose points lie nearest to the surface.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from industnerf.deviation.surface import Surface
from industnerf.geometry.sampling import sample_surface

ROTATIONS = 4096  # tried; neighbors are about 15 degrees apart
OFFSETS = (-0.1, 0.0, 0.1)  # diagonals, along each axis: a partial cloud has another centroid
SEARCH_POINTS, REFINE_POINTS, FINAL_POINTS = 256, 1024, 20_000
STARTS, FINALISTS = 24, 5  # poses that are refined, and those of them that are refined further
MIN_ANGLE = np.deg2rad(15.0)  # between starts
SCALE_RANGE = (0.8, 1.25)  # of a fitted scale, over that of the spreads
AXIS_TURNS = 120  # tried about each principal axis
GRID = 64  # cells of the grid of distances along each axis
GRID_MARGIN = 0.5  # of the diagonal, around the box
CAP = 0.02  # diagonals at which a distance counts no more: what lies farther is no part of it
START_STEPS, COARSE_STEPS, FINE_STEPS = 12, 60, 60
INLIERS = 0.85  # of the points, that are taken to be of the part
INLIER_SIGMAS = 1.44  # the 85 % quantile of distances that are normal, in standard deviations
TUKEY = 4.685  # standard deviations beyond which a point does not count -- Beaton & Tukey (1974)
CONVERGED = 1e-7  # diagonals
PREFERENCE = 1.02  # a move is taken only if it is this much better than to leave the cloud in place


@dataclass(frozen=True)
class Similarity:
    """p -> scale * rotation @ p + shift."""

    rotation: Float[np.ndarray, "3 3"]
    shift: Float[np.ndarray, "3"]
    scale: float = 1.0

    def __call__(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        return self.scale * points @ self.rotation.T + self.shift

    def matrix(self) -> Float[np.ndarray, "4 4"]:
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = self.scale * self.rotation, self.shift
        return matrix


IDENTITY = Similarity(np.eye(3), np.zeros(3))


@dataclass(frozen=True)
class Registration:
    """How a cloud was moved, and how well it then lies on the surface."""

    move: Similarity
    cost: float  # the mean distance from the surface, none beyond 2 % of the diagonal
    runner_up: float | None  # that of the best other pose, 15 degrees away or more


def register(
    points: Float[np.ndarray, "n 3"], surface: Surface, *, with_scale: bool
) -> Registration:
    """The rigid move of `points` onto `surface`, or the similarity `with_scale`.

    Deterministic.  Where the cloud fits nearly as well as it lies, it is only refined there.
    """
    rng = np.random.default_rng(0)
    few = _thin(points, REFINE_POINTS, rng)  # by chance: farthest points would be the strays
    samples = sample_surface(surface.vertices, surface.faces, 20_000, rng)[0]
    scale = _spread(samples) / _spread(few) if with_scale else 1.0
    starts = [IDENTITY, *_search(few[:SEARCH_POINTS], samples, surface, scale)]
    finalists = _finalists(starts, few, surface, with_scale)
    many = _thin(points, FINAL_POINTS, rng)
    chosen = min(finalists, key=lambda move: _cost(move(many), surface))
    # once more round the axes of the part: wheels have many poses that differ by a key
    turned = [chosen, *(_turned(chosen, turn, samples) for turn in _axis_turns(samples))]
    finalists = [finalists[0], *_finalists(turned, few, surface, with_scale), *finalists[1:]]
    costs = [_cost(move(many), surface) for move in finalists]
    best = int(np.argmin(costs))
    chosen = finalists[0 if costs[0] <= PREFERENCE * costs[best] else best]
    move = _refine(many, surface, chosen, FINE_STEPS, with_scale)
    others = [c for m, c in zip(finalists, costs, strict=True) if _angle(m, chosen) > MIN_ANGLE]
    return Registration(move, _cost(move(many), surface), min(others, default=None))


def free_scale(
    points: Float[np.ndarray, "n 3"], surface: Surface, start: Similarity
) -> tuple[float, float]:
    """The scale, over that of `start`, with which the cloud fits best, and its cost then."""
    many = _thin(points, FINAL_POINTS, np.random.default_rng(0))
    move = _refine(many, surface, start, FINE_STEPS, with_scale=True)
    return move.scale / start.scale, _cost(move(many), surface)


def size_ratio(points: Float[np.ndarray, "n 3"], surface: Surface) -> float:
    """How many times as large as the part the cloud is, by the spread of its points."""
    samples = sample_surface(
        surface.vertices, surface.faces, FINAL_POINTS, np.random.default_rng(0)
    )[0]
    return _spread(points) / _spread(samples)


def _finalists(
    starts: list[Similarity], few: np.ndarray, surface: Surface, with_scale: bool
) -> list[Similarity]:
    """The first of `starts` and the best others of them, refined."""
    costs = [_cost(move(few), surface) for move in starts]
    order = [0, *(int(i) for i in np.argsort(costs) if i)][: 1 + STARTS]
    moves = [
        _refine(few[:SEARCH_POINTS], surface, starts[i], START_STEPS, with_scale) for i in order
    ]
    costs = [_cost(move(few), surface) for move in moves]
    order = [0, *(int(i) for i in np.argsort(costs) if i)][: 1 + FINALISTS]
    return [_refine(few, surface, moves[i], COARSE_STEPS, with_scale) for i in order]


def _axis_turns(samples: np.ndarray) -> list[Float[np.ndarray, "3 3"]]:
    """Turns about each of the three principal axes of the part, all round."""
    axes = np.linalg.eigh(np.cov(samples.T))[1].T
    angles = 2 * np.pi * np.arange(1, AXIS_TURNS) / AXIS_TURNS
    return [Rotation.from_rotvec(angle * axis).as_matrix() for axis in axes for angle in angles]


def _turned(move: Similarity, turn: np.ndarray, samples: np.ndarray) -> Similarity:
    """`move`, and then `turn` about the middle of the part."""
    center = samples.mean(axis=0)
    return Similarity(turn @ move.rotation, turn @ (move.shift - center) + center, move.scale)


def _thin(points: np.ndarray, count: int, rng: np.random.Generator) -> np.ndarray:
    return points if len(points) <= count else points[rng.choice(len(points), count, replace=False)]


def _spread(points: np.ndarray) -> float:
    """The median distance from the centroid."""
    return float(np.median(np.linalg.norm(points - points.mean(axis=0), axis=1)))


def _search(
    points: np.ndarray, samples: np.ndarray, surface: Surface, scale: float
) -> list[Similarity]:
    """The best of many rotations about the centroids, far apart from one another."""
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    margin = GRID_MARGIN * surface.diagonal
    low, step = low - margin, (high - low + 2 * margin) / (GRID - 1)
    axes = [start + width * np.arange(GRID) for start, width in zip(low, step, strict=True)]
    cells = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    distances = cKDTree(samples).query(cells)[0].reshape(GRID, GRID, GRID)
    field = np.minimum(distances, 5 * CAP * surface.diagonal)  # a start need not be so near
    rotations = Rotation.random(ROTATIONS, rng=np.random.default_rng(0)).as_matrix()
    centered, target = scale * (points - points.mean(axis=0)), samples.mean(axis=0)
    offsets = surface.diagonal * np.stack(np.meshgrid(*[OFFSETS] * 3), axis=-1).reshape(-1, 3)
    origins = (target + offsets - low)[:, None] / step
    costs = np.empty((ROTATIONS, len(offsets)))
    for i, rotation in enumerate(rotations):
        cells = np.rint(origins + centered @ rotation.T / step).astype(np.int64)
        x, y, z = np.moveaxis(np.clip(cells, 0, GRID - 1), -1, 0)
        costs[i] = field[x, y, z].mean(axis=1)
    chosen: list[Similarity] = []
    for flat in np.argsort(costs, axis=None):
        i, j = divmod(int(flat), len(offsets))
        shift = target + offsets[j] - scale * rotations[i] @ points.mean(axis=0)
        move = Similarity(rotations[i], shift, scale)
        if all(_angle(move, other) > MIN_ANGLE for other in chosen):
            chosen.append(move)
        if len(chosen) == STARTS:
            break
    return chosen


def _angle(a: Similarity, b: Similarity) -> float:
    """Between two rotations, in radians."""
    return float(Rotation.from_matrix(a.rotation @ b.rotation.T).magnitude())


def _refine(
    points: np.ndarray, surface: Surface, start: Similarity, steps: int, with_scale: bool
) -> Similarity:
    """Point to plane, with Tukey's weights: a step solves for the small move that is best.

    -- Chen & Medioni (1992), Object modelling by registration of multiple range images.
    """
    move = start
    for _ in range(steps):
        moved = move(points)
        nearest = surface.nearest(moved)
        offset = moved - nearest.points
        distance = np.linalg.norm(offset, axis=1)
        # across the surface, be the nearest point on an edge: there the offset is the direction
        on_face = np.abs((offset * nearest.normals).sum(axis=1)) > 0.99 * distance
        direction = np.where(
            on_face[:, None], nearest.normals, offset / np.maximum(distance, 1e-300)[:, None]
        )
        # not the median: most of a plate is its faces, along which it slides
        sigma = max(np.quantile(distance, INLIERS) / INLIER_SIGMAS, 1e-9 * surface.diagonal)
        weight = np.maximum(1 - (distance / (TUKEY * sigma)) ** 2, 0)  # the root of Tukey's
        center = moved.mean(axis=0)
        arm = moved - center
        columns = [np.cross(arm, direction), direction]
        if with_scale:
            columns.append((arm * direction).sum(axis=1, keepdims=True))
        system = np.hstack(columns) * weight[:, None]
        target = -(offset * direction).sum(axis=1) * weight
        # columns of rotations are lengths: in diagonals all are alike
        units = np.r_[
            np.full(3, surface.diagonal), np.ones(3), np.full(int(with_scale), surface.diagonal)
        ]
        step = np.linalg.lstsq(system / units, target, rcond=1e-6)[0] / units
        turn = Rotation.from_rotvec(step[:3]).as_matrix()
        # bounded: shrunk to a point on the surface, any cloud would fit
        bounds = np.array(SCALE_RANGE) * start.scale / move.scale
        growth = float(np.clip(1 + step[6], *bounds)) if with_scale else 1.0
        shift = growth * turn @ (move.shift - center) + center + step[3:6]
        move = Similarity(turn @ move.rotation, shift, growth * move.scale)
        if np.abs(step * units).max() < CONVERGED * surface.diagonal:
            break
    return move


def _cost(points: np.ndarray, surface: Surface) -> float:
    """The mean distance from the surface, none of which counts beyond CAP."""
    distance = np.abs(surface.nearest(points).signed_distance)
    return float(np.minimum(distance, CAP * surface.diagonal).mean())
