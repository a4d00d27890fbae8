"""The forms that the non-industrial set is made of: level sets, tubes, sheets, turned bodies.

Lengths are in mm.  Every form is a closed `Manifold`; `edge_mm` is about the length of the edges
of its triangles, so half of it meshes four times finer.
"""

from array import array
from collections.abc import Callable

import numpy as np
from jaxtyping import Float, Int
from manifold3d import CrossSection, Error, Manifold, Mesh64, OpType
from scipy.interpolate import CubicSpline

from industnerf.errors import BadPart

Points = Float[np.ndarray, "n 3"]
Field = Callable[[Points], Float[np.ndarray, "n"]]
"""Positive inside a body, negative outside."""


def solid(vertices: Points, faces: Int[np.ndarray, "m 3"]) -> Manifold:
    """A closed mesh as a body; raises `BadPart` if it is none."""
    corners = np.ascontiguousarray(faces, np.uint64)
    body = Manifold(Mesh64(np.ascontiguousarray(vertices, np.float64), corners))
    if body.status() != Error.NoError:
        raise BadPart(f"a form of {len(faces)} faces is refused: {body.status().name}")
    return body


def union(bodies: list[Manifold]) -> Manifold:
    return Manifold.batch_boolean(bodies, OpType.Add)


def level_set(field: Field, low: list[float], high: list[float], edge_mm: float) -> Manifold:
    """The body where `field` is positive, within the box from `low` to `high`.

    The library asks for one point at a time, and for the same points each time it is called: so
    it is called once to hear them, and again to be answered.
    """
    query_points = array("d")

    def record_point(x: float, y: float, z: float) -> float:
        query_points.extend((x, y, z))
        return -1.0

    Manifold.level_set(record_point, [*low, *high], edge_mm)
    values = iter(field(np.array(query_points).reshape(-1, 3)).tolist())
    body = Manifold.level_set(lambda x, y, z: next(values), [*low, *high], edge_mm)
    return body.warp_batch(lambda points: _project_to_surface(field, np.array(points), edge_mm))


def _project_to_surface(field: Field, points: Points, edge_mm: float) -> Points:
    """Points near the surface moved onto it, by one step of Newton's along the gradient."""
    step = 1e-3 * edge_mm
    sides = step * np.eye(3)
    slope = [(field(points + side) - field(points - side)) / (2 * step) for side in sides]
    gradient = np.stack(slope, axis=1)
    squared = np.maximum(np.einsum("ij,ij->i", gradient, gradient), 1e-12)
    move = -gradient * (field(points) / squared)[:, None]
    length = np.linalg.norm(move, axis=1, keepdims=True)
    return points + move * np.minimum(1.0, 0.2 * edge_mm / np.maximum(length, 1e-12))


def curve(points: Float[np.ndarray, "knots d"], spacing: float) -> Float[np.ndarray, "n d"]:
    """A smooth curve through `points` (a spline over their chord length), evenly resampled."""
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(chords)])
    steps = max(4, round(along[-1] / spacing))
    return CubicSpline(along, points)(np.linspace(0.0, along[-1], steps + 1))


def tube(
    centers: Points, radii: Float[np.ndarray, "n"], edge_mm: float, closed: bool = False
) -> Manifold:
    """A round tube about a line, with round ends or else `closed`; it must not meet itself.

    Its cross section is a polygon of the circle's area.
    """
    sides = max(8, round(2 * np.pi * float(radii.max()) / edge_mm))
    if closed:
        frames = _frames(_unit(np.roll(centers, -1, axis=0) - np.roll(centers, 1, axis=0)))
        return _looped(_rings(centers, radii, _untwisted(frames), sides))
    tangents = _unit(np.gradient(centers, axis=0))
    ends = [centers[i] + sign * radii[i] * tangents[i] for i, sign in ((0, -1), (-1, 1))]
    centers, radii, tangents = _rounded(centers, radii, tangents, max(2, sides // 4))
    return _capped(_rings(centers, radii, _frames(tangents), sides), np.array(ends))


def _rounded(
    centers: Points, radii: Float[np.ndarray, "n"], tangents: Points, steps: int
) -> tuple[Float[np.ndarray, "k 3"], Float[np.ndarray, "k"], Float[np.ndarray, "k 3"]]:
    """Half a ball of rings added at either end; the poles themselves stay out."""
    turn = np.pi / 2 * np.arange(1, steps) / steps
    out, back = turn[:, None], turn[::-1, None]
    before = centers[0] - radii[0] * np.sin(back) * tangents[0]
    after = centers[-1] + radii[-1] * np.sin(out) * tangents[-1]
    waist = [radii[0] * np.cos(turn[::-1]), radii, radii[-1] * np.cos(turn)]
    still = [np.broadcast_to(tangents[i], before.shape) for i in (0, -1)]
    return (
        np.concatenate([before, centers, after]),
        np.concatenate(waist),
        np.concatenate([still[0], tangents, still[1]]),
    )


def _frames(tangents: Points) -> Float[np.ndarray, "n 2 3"]:
    """Two unit vectors across each tangent, carried along without twist."""
    across = np.linalg.svd(tangents[:1])[2][1]
    frames = []
    for tangent in tangents:
        across = _unit(across - (across @ tangent) * tangent)
        frames.append((across, np.cross(tangent, across)))
    return np.array(frames)


def _untwisted(frames: Float[np.ndarray, "n 2 3"]) -> Float[np.ndarray, "n 2 3"]:
    """Frames of a closed line that come back as they started: the difference is spread out."""
    (across, aside), last = frames[0], frames[-1, 0]
    n = len(frames)
    turn = np.arctan2(last @ aside, last @ across) * np.arange(n)[:, None] / n
    u, v = frames[:, 0], frames[:, 1]
    turned = (np.cos(turn) * u - np.sin(turn) * v, np.sin(turn) * u + np.cos(turn) * v)
    return np.stack(turned, axis=1)


def _rings(
    centers: Points, radii: Float[np.ndarray, "n"], frames: Float[np.ndarray, "n 2 3"], sides: int
) -> Float[np.ndarray, "n sides 3"]:
    angles = 2 * np.pi * np.arange(sides) / sides
    unit = np.stack([np.cos(angles), np.sin(angles)], axis=1) / np.sqrt(np.sinc(2 / sides))
    return centers[:, None] + radii[:, None, None] * np.einsum("sk,nkd->nsd", unit, frames)


def _looped(rings: Float[np.ndarray, "n sides 3"]) -> Manifold:
    n, sides, _ = rings.shape
    return solid(rings.reshape(-1, 3), grid_faces(n + 1, sides, is_ring=True) % (n * sides))


def _capped(rings: Float[np.ndarray, "n sides 3"], ends: Float[np.ndarray, "2 3"]) -> Manifold:
    """Rings of points joined to a tube, closed by a fan about a point at either end."""
    n, sides, _ = rings.shape
    index = np.arange(sides)
    ahead, last = (index + 1) % sides, (n - 1) * sides
    first_end = np.full(sides, n * sides)
    fans = [
        np.stack([first_end, ahead, index], axis=1),
        np.stack([first_end + 1, last + index, last + ahead], axis=1),
    ]
    faces = np.vstack([grid_faces(n, sides, is_ring=True), *fans])
    return solid(np.concatenate([rings.reshape(-1, 3), ends]), faces)


def sheet(
    midsurface: Float[np.ndarray, "n m 3"], thickness: float, is_ring: bool = False
) -> Manifold:
    """A sheet of `thickness` about a grid of points; `is_ring`: each row is closed."""
    n, m, _ = midsurface.shape
    along = np.gradient(midsurface, axis=0)
    wrapped = np.roll(midsurface, -1, axis=1) - np.roll(midsurface, 1, axis=1)
    across = wrapped if is_ring else np.gradient(midsurface, axis=1)
    offset = _unit(np.cross(along, across)) * thickness / 2
    quads, below = grid_faces(n, m, is_ring), n * m
    walls = [_wall(border, below) for border in _borders(n, m, is_ring)]
    both = [(midsurface + offset).reshape(-1, 3), (midsurface - offset).reshape(-1, 3)]
    return solid(np.concatenate(both), np.vstack([quads[:, ::-1], quads + below, *walls]))


def _borders(n: int, m: int, is_ring: bool) -> list[Int[np.ndarray, "k"]]:
    """The closed lines that bound a grid, as indices of its points."""
    index = np.arange(n * m).reshape(n, m)
    if is_ring:
        return [index[0], index[-1, ::-1]]
    return [np.concatenate([index[0, :-1], index[:-1, -1], index[-1, :0:-1], index[:0:-1, 0]])]


def _wall(border: Int[np.ndarray, "k"], below: int) -> Int[np.ndarray, "f 3"]:
    ahead = np.roll(border, -1)
    near = np.stack([border, ahead, border + below], axis=1)
    return np.vstack([near, np.stack([ahead, ahead + below, border + below], axis=1)])


def grid_faces(n: int, m: int, is_ring: bool) -> Int[np.ndarray, "f 3"]:
    """The triangles of an n by m grid of points, row by row; `is_ring`: each row is closed."""
    index = np.arange(n * m).reshape(n, m)
    right = np.roll(index, -1, axis=1) if is_ring else index[:, 1:]
    left = index if is_ring else index[:, :-1]
    a, b, c, d = left[:-1], right[:-1], right[1:], left[1:]
    return np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])


def revolve_profile(profile: Float[np.ndarray, "n 2"], edge_mm: float) -> Manifold:
    """What a wheel makes of a closed outline of (radius, z), counterclockwise."""
    segments = max(12, round(2 * np.pi * float(profile[:, 0].max()) / edge_mm))
    return Manifold.revolve(CrossSection([profile]), segments)


def _unit(vectors: Float[np.ndarray, "*any 3"]) -> Float[np.ndarray, "*any 3"]:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def plane_wave_noise(
    points: Points, seed: int, length_mm: float, octaves: int
) -> Float[np.ndarray, "n"]:
    """sum_o 2^-o / sqrt(12) sum_k sin(2^o a_k . p + b_k): 24 random waves an octave.

    The longest are of about `length_mm`; the sum has a standard deviation of about 1.
    """
    rng = np.random.default_rng(seed)
    total = np.zeros(len(points))
    for octave in range(octaves):
        wave_vectors = rng.normal(size=(24, 3)) * 2**octave * 2 * np.pi / length_mm / 3**0.5
        phase = rng.uniform(0, 2 * np.pi, 24)
        total += np.sin(points @ wave_vectors.T + phase).sum(axis=1) / 12**0.5 / 2**octave
    return total
