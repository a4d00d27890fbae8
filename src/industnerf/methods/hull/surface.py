"""Area-uniform points of the hull's surface.

A short segment in random position and direction crosses a surface with a probability that is
proportional to the area there, whichever way it faces (Crofton).  So segments that start
anywhere in the open cells cross the hull's surface in independent, area-uniform points: no
normal is needed, and edges, corners and thin walls get what is theirs.
"""

import numpy as np
from jaxtyping import Float32, Int

from industnerf.errors import ReconstructionFailed
from industnerf.methods.hull.octree import OCTANTS, Families
from industnerf.methods.hull.silhouettes import Silhouettes, bilinear

SEGMENT = 0.5  # length in sides of a cell
PER_POINT = 22  # segments drawn for a point: some 5 % cross
SELDOM = 1e-3  # if fewer cross, there is hardly any hull, and no end of drawing


def draw(
    seen: Silhouettes, families: Families, count: int, rng: np.random.Generator
) -> Float32[np.ndarray, "n 3"]:
    """`count` independent points, uniform over the surface, in the unit frame.

    Fewer if there is hardly any surface; raises ReconstructionFailed if there is none.
    """
    segments = int(np.clip(PER_POINT * count, 1 << 14, 1 << 21))
    found = np.empty((0, 3), np.float32)
    while families.count and len(found) < count:
        more = crossings(seen, families, segments, rng)
        found = np.concatenate([found, more])
        if len(more) < SELDOM * segments:
            break
    if not len(found):
        raise ReconstructionFailed(
            f"no surface: {families.count} cells are neither inside nor outside, and no segment "
            "in them crosses one; the silhouettes have no outline, or no volume in common"
        )
    return rng.permutation(found)[:count]


def crossings(
    seen: Silhouettes, families: Families, segments: int, rng: np.random.Generator
) -> Float32[np.ndarray, "n 3"]:
    """Where the surface is crossed by `segments` that start in random children, if these are open.

    They come sorted by cell.
    """
    child = np.sort(rng.integers(8 * len(families.open), size=segments))
    child = child[np.unpackbits(families.open)[child] > 0]
    side = np.float32(families.side / 2)
    corner = 2 * families.parents[child >> 3] + OCTANTS[child & 7]
    start = (corner + rng.random((len(child), 3), np.float32)) * side - np.float32(1)
    step = rng.standard_normal((len(child), 3), np.float32)
    step *= (np.float32(SEGMENT) * side / np.linalg.norm(step, axis=1))[:, None]
    before, after = clearance(seen, families, child, np.stack([start, start + step]))
    crosses = (before > 0) != (after > 0)
    share = before[crosses] / (before[crosses] - after[crosses])
    return start[crosses] + share[:, None] * step[crosses]


def clearance(
    seen: Silhouettes,
    families: Families,
    child: Int[np.ndarray, "n"],
    points: Float32[np.ndarray, "ends n 3"],
) -> Float32[np.ndarray, "ends n"]:
    """About how deep the points lie in the hull, negative outside; exact in sign.

    Only the views that the child (8 * family + octant) is open in are asked; of the others the
    points are inside.
    """
    least = np.full(points.shape[:2], np.inf, np.float32)
    bit, byte = np.uint8(128) >> (child & 7).astype(np.uint8), np.zeros_like(families.open)
    for view, (members, bits) in enumerate(families.views):
        byte[members] = bits
        at = np.flatnonzero(byte[child >> 3] & bit)
        byte[members] = 0
        matrix = seen.projection[view]
        for deep, end in zip(least, points, strict=True):
            u, v, depth = matrix[:, :3] @ end[at].T + matrix[:, 3:]
            inside = bilinear(seen.distance[view], u / depth, v / depth) * depth
            deep[at] = np.minimum(deep[at], inside / seen.stretch[view])
    return least
