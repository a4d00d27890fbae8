"""Limbs that flow into each other: a long-necked animal and a branching coral."""

import numpy as np
from jaxtyping import Float, Int
from manifold3d import Manifold

from industnerf.artifacts.part import Mesh
from industnerf.parts.catalogue.organic.face_colors import assemble, color_faces
from industnerf.parts.catalogue.organic.forms import Points, level_set

Joint = Float[np.ndarray, "4"]
Bones = Float[np.ndarray, "k 2 4"]
"""Both ends of each limb: x, y, z and radius, in mm."""

FAR = 7.0  # blends; a limb further away than this adds less than 1/1000 to the union

BODY = (  # x, y, z and radius from the tail's tip to the snout, as shares of the length
    (-0.50, 0.02, 0.20, 0.012),
    (-0.37, -0.01, 0.19, 0.020),
    (-0.25, 0.00, 0.21, 0.036),
    (-0.12, 0.01, 0.25, 0.070),
    (0.01, 0.01, 0.26, 0.088),
    (0.12, 0.00, 0.27, 0.070),
    (0.21, 0.00, 0.33, 0.043),
    (0.27, 0.00, 0.43, 0.032),
    (0.32, 0.00, 0.53, 0.029),
    (0.37, 0.00, 0.58, 0.040),
    (0.43, 0.00, 0.57, 0.030),
)
FORELEG = ((0.11, 0.05, 0.23, 0.045), (0.13, 0.075, 0.12, 0.033), (0.12, 0.08, 0.02, 0.034))
HINDLEG = ((-0.09, 0.05, 0.23, 0.056), (-0.08, 0.08, 0.13, 0.038), (-0.11, 0.085, 0.02, 0.036))
EYE = (0.383, 0.033, 0.592, 0.012)


def sauropod(edge_mm: float, length: float, stripes: int) -> Mesh:
    """Tapered limbs in a smooth union, feet cut flat; stripes across the back, black eyes."""
    legs = [np.array(leg) * (1, side, 1, 1) for leg in (FORELEG, HINDLEG) for side in (1, -1)]
    bones = length * np.concatenate([_chain(limb) for limb in (np.array(BODY), *legs)])
    body = limbs(bones, 0.012 * length, edge_mm).trim_by_plane((0, 0, 1), 0)
    eyeballs = [_ball(length * np.array(EYE) * (1, side, 1, 1), edge_mm) for side in (1, -1)]
    mesh = assemble([body, eyeballs[0] + eyeballs[1]])
    spine = length * np.array(BODY)

    def back(points: Points) -> Float[np.ndarray, "n"]:
        middle = np.interp(points[:, 0], spine[:, 0], spine[:, 2])
        return points[:, 2] - middle - 0.015 * length

    def band(points: Points) -> Float[np.ndarray, "n"]:
        return np.sin(2 * np.pi * stripes * points[:, 0] / length) - 0.2

    return color_faces(mesh, [back, band], lambda p: np.where((back(p) > 0) & (band(p) > 0), 2, 0))


def coral(edge_mm: float, height: float, forks: int, seed: int) -> Mesh:
    """An L-system: every branch ends in two, each 0.8 as long, turned about 30 degrees.

    The tips are pale.
    """
    rng = np.random.default_rng(seed)
    trunk = (np.array([0.0, 0.0, 0.0, 0.075]), np.array([0.0, 0.0, 0.17, 0.062]))
    foot = (np.array([0.0, 0.0, 0.0, 0.13]), np.array([0.0, 0.0, 0.01, 0.12]))
    bones = height * np.array([foot, trunk, *_forked(trunk[1], forks, rng)])
    body = limbs(bones, 0.012 * height, edge_mm).trim_by_plane((0, 0, 1), 0)
    tips = bones[-(2**forks) :, 1, :3]

    def tip(points: Points) -> Float[np.ndarray, "n"]:
        return 0.05 * height - np.linalg.norm(points[:, None] - tips, axis=2).min(axis=1)

    return color_faces(assemble([body]), [tip], lambda p: np.where(tip(p) > 0, 1, 0))


def _forked(root: Joint, forks: int, rng: np.random.Generator) -> list[tuple[Joint, Joint]]:
    """The limbs above `root`, level by level, so that the last are the tips; shares of a height."""
    buds, limbs_so_far = [(root, np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]))], []
    for level in range(forks):
        next_buds = []
        for start, ahead, across in buds:
            for sign in (1, -1):
                turn = np.radians(rng.uniform(24, 42))
                direction = np.cos(turn) * ahead + sign * np.sin(turn) * across + [0, 0, 0.1]
                direction /= np.linalg.norm(direction)
                end = np.append(start[:3] + 0.22 * 0.8**level * direction, 0.92 * start[3])
                limbs_so_far.append((start, end))
                twisted = np.cross(direction, across) + rng.uniform(-0.5, 0.5) * across
                twisted -= (twisted @ direction) * direction
                next_buds.append((end, direction, twisted / np.linalg.norm(twisted)))
        buds = next_buds
    return limbs_so_far


def limbs(bones: Bones, blend: float, edge_mm: float) -> Manifold:
    """Round limbs of linearly changing radius in a smooth union: f = b log sum exp(f_i / b)."""
    reach = bones[:, :, 3:].max(axis=1) + FAR * blend
    lows, highs = bones[:, :, :3].min(axis=1) - reach, bones[:, :, :3].max(axis=1) + reach

    def field(points: Points) -> Float[np.ndarray, "n"]:
        total = np.full(len(points), np.exp(-FAR))
        for (start, end), low, high in zip(bones, lows, highs, strict=True):
            near = _points_in_box(points, low, high)
            total[near] += np.exp(_signed_depth(points[near], start, end) / blend)
        return blend * np.log(total)

    return level_set(field, lows.min(axis=0).tolist(), highs.max(axis=0).tolist(), edge_mm)


def _points_in_box(
    points: Points, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]
) -> Int[np.ndarray, "k"]:
    """Which points lie in a box, axis after axis."""
    near = np.arange(len(points))
    for axis in range(3):
        x = points[near, axis]
        near = near[(x > low[axis]) & (x < high[axis])]
    return near


def _signed_depth(points: Points, start: Joint, end: Joint) -> Float[np.ndarray, "n"]:
    """How deep points lie in one limb."""
    along = end[:3] - start[:3]
    t = np.clip((points - start[:3]) @ along / (along @ along), 0, 1)
    gap = points - start[:3] - t[:, None] * along
    return start[3] + t * (end[3] - start[3]) - np.sqrt(np.einsum("ij,ij->i", gap, gap))


def _chain(joints: Float[np.ndarray, "n 4"]) -> Bones:
    return np.stack([joints[:-1], joints[1:]], axis=1)


def _ball(sphere: Float[np.ndarray, "4"], edge_mm: float) -> Manifold:
    sides = max(16, round(2 * np.pi * float(sphere[3]) / edge_mm))
    return Manifold.sphere(float(sphere[3]), sides).translate(sphere[:3].tolist())
