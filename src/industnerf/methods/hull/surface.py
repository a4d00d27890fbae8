"""Area-uniform points of the hull's surface.

A short segment in random position and direction crosses a surface with a probability that is
proportional to the area there, whichever way it faces (Crofton).  So segments that start
anywhere in the open cells cross the hull's surface in independent, area-uniform points: no
normal is needed, and edges, corners and thin walls get what is theirs.
"""

import numpy as np
from jaxtyping import Float32, Int

from industnerf.errors import ReconstructionFailed
from industnerf.methods.hull.octree import OCTANTS, OctreeNodes
from industnerf.methods.hull.silhouettes import Silhouettes, bilinear

SEGMENT_LENGTH = 0.5  # length in sides of a cell
SEGMENTS_PER_POINT = 22  # segments drawn for a point: some 5 % cross
MIN_CROSSING_RATE = 1e-3  # if fewer cross, there is hardly any hull, and no end of drawing


def sample_hull_surface(
    silhouettes: Silhouettes, nodes: OctreeNodes, count: int, rng: np.random.Generator
) -> Float32[np.ndarray, "n 3"]:
    """`count` independent points, uniform over the surface, in the unit frame.

    Fewer if there is hardly any surface; raises ReconstructionFailed if there is none.
    """
    segments = int(np.clip(SEGMENTS_PER_POINT * count, 1 << 14, 1 << 21))
    points = np.empty((0, 3), np.float32)
    while nodes.num_open and len(points) < count:
        new_points = surface_crossings(silhouettes, nodes, segments, rng)
        points = np.concatenate([points, new_points])
        if len(new_points) < MIN_CROSSING_RATE * segments:
            break
    if not len(points):
        raise ReconstructionFailed(
            f"no surface: {nodes.num_open} cells are neither inside nor outside, and no segment "
            "in them crosses one; the silhouettes have no outline, or no volume in common"
        )
    return rng.permutation(points)[:count]


def surface_crossings(
    silhouettes: Silhouettes, nodes: OctreeNodes, segments: int, rng: np.random.Generator
) -> Float32[np.ndarray, "n 3"]:
    """Where the surface is crossed by `segments` that start in random children, if these are open.

    They come sorted by cell.
    """
    child = np.sort(rng.integers(8 * len(nodes.open_children), size=segments))
    child = child[np.unpackbits(nodes.open_children)[child] > 0]
    side = np.float32(nodes.side / 2)
    corner = 2 * nodes.parents[child >> 3] + OCTANTS[child & 7]
    start = (corner + rng.random((len(child), 3), np.float32)) * side - np.float32(1)
    step = rng.standard_normal((len(child), 3), np.float32)
    step *= (np.float32(SEGMENT_LENGTH) * side / np.linalg.norm(step, axis=1))[:, None]
    before, after = silhouette_distance(silhouettes, nodes, child, np.stack([start, start + step]))
    crosses = (before > 0) != (after > 0)
    share = before[crosses] / (before[crosses] - after[crosses])
    return start[crosses] + share[:, None] * step[crosses]


def silhouette_distance(
    silhouettes: Silhouettes,
    nodes: OctreeNodes,
    child: Int[np.ndarray, "n"],
    points: Float32[np.ndarray, "ends n 3"],
) -> Float32[np.ndarray, "ends n"]:
    """About how deep the points lie in the hull, negative outside; exact in sign.

    Only the views that the child (8 * parent + octant) is open in are evaluated; in the others the
    points are inside.
    """
    min_depth = np.full(points.shape[:2], np.inf, np.float32)
    bit, byte = np.uint8(128) >> (child & 7).astype(np.uint8), np.zeros_like(nodes.open_children)
    for view, (members, bits) in enumerate(nodes.views):
        byte[members] = bits
        selected = np.flatnonzero(byte[child >> 3] & bit)
        byte[members] = 0
        matrix = silhouettes.projection[view]
        for view_depth, end in zip(min_depth, points, strict=True):
            u, v, depth = matrix[:, :3] @ end[selected].T + matrix[:, 3:]
            inside = bilinear(silhouettes.distance[view], u / depth, v / depth) * depth
            view_depth[selected] = np.minimum(
                view_depth[selected], inside / silhouettes.max_focal_px[view]
            )
    return min_depth
