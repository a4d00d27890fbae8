"""The cells that the hull's surface may cross, divided until they are small.

A cell is outside if one view shows background wherever the cell may lie in it, and inside a
view that shows the part wherever it may lie.  A cell that is neither outside, nor inside every
view, is open.  Only open cells are divided, and a child is tested only in the views that its
parent is open in: of the others it is inside.

Eight children are the bits of one byte, the first of them the highest (`np.packbits`).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Int16, Int32, UInt8

from industnerf.methods.hull.silhouettes import Silhouettes, bilinear

ROOT_PX = 8.0  # side of the first cells: distances are exact to MAX_DISTANCE_PX alone
MIN_ROOT_CELLS = 32  # the first cells are at least so many a side: see MAX_CELL_DISTANCE
BATCH_SIZE = 1024  # parents tested together, so that their arrays stay in the cache
OCTANTS = np.indices((2, 2, 2)).reshape(3, -1).T.astype(np.int16)
ALL_CHILDREN = np.uint8(255)

NodeIndices = Int32[np.ndarray, "_"]
ChildBits = UInt8[np.ndarray, "_"]


@dataclass(frozen=True)
class OctreeNodes:
    """Parents on a lattice of spacing `side` that begins at (-1, -1, -1), and their children."""

    parents: Int16[np.ndarray, "n 3"]
    side: float  # of a parent
    open_children: UInt8[np.ndarray, "n"]  # which children are
    views: list[tuple[NodeIndices, ChildBits]]  # families with children open in the view, and which

    @property
    def num_open(self) -> int:
        """How many children are open."""
        return int(np.bitwise_count(self.open_children).sum(dtype=np.int64))


def refine(silhouettes: Silhouettes, cell_px: float, margin_sides: float) -> OctreeNodes:
    """Families whose children project to at most `cell_px` in the nearest view.

    The class of a cell holds for points within `margin_sides` sides of a last child around it.
    """
    cells_across = 2 / (cell_px * silhouettes.pixel_size)  # the region of interest in last children
    subdivisions = max(0, int(np.log2(min(ROOT_PX / cell_px, cells_across / MIN_ROOT_CELLS))))
    roots_across = int(np.ceil(max(MIN_ROOT_CELLS, cells_across / 2**subdivisions) / 2))
    parents = root_cells(roots_across)
    all_nodes = np.arange(len(parents), dtype=np.int32)
    margin = margin_sides / (roots_across * 2**subdivisions)
    nodes = subdivide(
        silhouettes, parents, 2 / roots_across, [all_nodes] * len(silhouettes.distance), margin
    )
    for _ in range(subdivisions):
        nodes = subdivide(silhouettes, *child_nodes(nodes), margin)
    return nodes


def root_cells(cells_across: int) -> Int16[np.ndarray, "n 3"]:
    """Of `cells_across`^3 cells that tile the cube around the unit ball, those that may meet it."""
    cells = np.indices((cells_across,) * 3, np.int16).reshape(3, -1).T
    centers = (cells + 0.5) * (2 / cells_across) - 1
    return cells[np.linalg.norm(centers, axis=1) <= 1 + np.sqrt(3) / cells_across]


def child_nodes(
    nodes: OctreeNodes,
) -> tuple[Int16[np.ndarray, "n 3"], float, list[NodeIndices]]:
    """The open children as parents of the next families: cells, side, members of each view."""
    open_indices = np.flatnonzero(np.unpackbits(nodes.open_children))
    cells = 2 * nodes.parents[open_indices >> 3] + OCTANTS[open_indices & 7]
    new_index = np.empty(8 * len(nodes.open_children), np.int32)
    new_index[open_indices] = np.arange(len(open_indices), dtype=np.int32)
    views = []
    for members, bits in nodes.views:
        selected = np.flatnonzero(np.unpackbits(bits & nodes.open_children[members]))
        views.append(new_index[(members[selected >> 3] << 3) + (selected & 7)])
    return cells, nodes.side / 2, views


def subdivide(
    silhouettes: Silhouettes,
    parents: Int16[np.ndarray, "n 3"],
    side: float,
    views: list[NodeIndices],
    margin: float,
) -> OctreeNodes:
    """Test the children of `parents`, each in the `views` that its parent is a member of."""
    centers = (parents + np.float32(0.5)) * np.float32(side) - np.float32(1)
    offsets = ((OCTANTS - 0.5) * (side / 2)).astype(np.float32)
    radius = np.float32(np.sqrt(3) / 4 * side + margin)
    outside, open_ = np.zeros((2, len(parents)), np.uint8)
    open_views = []
    for view, members in enumerate(views):
        active = members[outside[members] != ALL_CHILDREN]
        bits = np.empty(len(active), np.uint8)
        for start in range(0, len(active), BATCH_SIZE):
            batch = active[start : start + BATCH_SIZE]
            out, is_open = classify_cells(silhouettes, view, centers[batch], offsets, radius)
            outside[batch] |= out
            open_[batch] |= is_open
            bits[start : start + BATCH_SIZE] = is_open
        batch = np.flatnonzero(bits)
        open_views.append((active[batch], bits[batch]))
    return OctreeNodes(parents, side, open_ & ~outside, open_views)


def classify_cells(
    silhouettes: Silhouettes,
    view: int,
    centers: Float32[np.ndarray, "n 3"],
    offsets: Float32[np.ndarray, "8 3"],
    radius: np.float32,
) -> tuple[UInt8[np.ndarray, "n"], UInt8[np.ndarray, "n"]]:
    """Which of the balls of `radius` about `centers` + `offsets` are outside, which are open."""
    matrix = silhouettes.projection[view]
    parent_pixels = centers @ matrix[:, :3].T + matrix[:, 3]
    child_offsets = offsets @ matrix[:, :3].T
    u, v, depth = (np.add.outer(parent_pixels[:, i], child_offsets[:, i]).ravel() for i in range(3))
    u /= depth
    v /= depth
    # outside: distance < -max_focal_px * radius / (least depth in the ball)
    depth -= radius
    distance = bilinear(silhouettes.distance[view], u, v) * depth
    reach = silhouettes.max_focal_px[view] * radius
    out = distance < -reach
    return np.packbits(out), np.packbits((distance <= reach) ^ out)
