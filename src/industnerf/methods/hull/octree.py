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

ROOT_PX = 8.0  # side of the first cells: beyond NEAR px from an outline nothing is known
ROOTS = 32  # the first cells are at least so many a side: see REACH
AT_ONCE = 1024  # families tested together, so that their arrays stay in the cache
OCTANTS = np.indices((2, 2, 2)).reshape(3, -1).T.astype(np.int16)
ALL = np.uint8(255)

Members = Int32[np.ndarray, "_"]
Bits = UInt8[np.ndarray, "_"]


@dataclass(frozen=True)
class Families:
    """Parents on a lattice of spacing `side` that begins at (-1, -1, -1), and their children."""

    parents: Int16[np.ndarray, "n 3"]
    side: float  # of a parent
    open: UInt8[np.ndarray, "n"]  # which children are
    views: list[tuple[Members, Bits]]  # families with children open in the view, and which

    @property
    def count(self) -> int:
        """How many children are open."""
        return int(np.bitwise_count(self.open).sum(dtype=np.int64))


def refine(seen: Silhouettes, cell_px: float, apron: float) -> Families:
    """Families whose children project to at most `cell_px` in the nearest view.

    A verdict on a cell holds for the points within `apron` sides of a last child around it too.
    """
    wide = 2 / (cell_px * seen.pixel)  # the region of interest in last children
    halvings = max(0, int(np.log2(min(ROOT_PX / cell_px, wide / ROOTS))))
    across = int(np.ceil(max(ROOTS, wide / 2**halvings) / 2))
    parents = first_parents(across)
    everyone = np.arange(len(parents), dtype=np.int32)
    margin = apron / (across * 2**halvings)
    families = divide(seen, parents, 2 / across, [everyone] * len(seen.distance), margin)
    for _ in range(halvings):
        families = divide(seen, *children(families), margin)
    return families


def first_parents(across: int) -> Int16[np.ndarray, "n 3"]:
    """Of `across`^3 cells that tile the cube around the unit ball, those that may meet it."""
    cells = np.indices((across,) * 3, np.int16).reshape(3, -1).T
    middles = (cells + 0.5) * (2 / across) - 1
    return cells[np.linalg.norm(middles, axis=1) <= 1 + np.sqrt(3) / across]


def children(
    families: Families,
) -> tuple[Int16[np.ndarray, "n 3"], float, list[Members]]:
    """The open children as parents of the next families: cells, side, members of each view."""
    kept = np.flatnonzero(np.unpackbits(families.open))
    cells = 2 * families.parents[kept >> 3] + OCTANTS[kept & 7]
    number = np.empty(8 * len(families.open), np.int32)
    number[kept] = np.arange(len(kept), dtype=np.int32)
    views = []
    for members, bits in families.views:
        at = np.flatnonzero(np.unpackbits(bits & families.open[members]))
        views.append(number[(members[at >> 3] << 3) + (at & 7)])
    return cells, families.side / 2, views


def divide(
    seen: Silhouettes,
    parents: Int16[np.ndarray, "n 3"],
    side: float,
    views: list[Members],
    margin: float,
) -> Families:
    """Test the children of `parents`, each in the `views` that its parent is a member of."""
    middles = (parents + np.float32(0.5)) * np.float32(side) - np.float32(1)
    offsets = ((OCTANTS - 0.5) * (side / 2)).astype(np.float32)
    radius = np.float32(np.sqrt(3) / 4 * side + margin)
    outside, open_ = np.zeros((2, len(parents)), np.uint8)
    found = []
    for view, members in enumerate(views):
        left = members[outside[members] != ALL]
        bits = np.empty(len(left), np.uint8)
        for at in range(0, len(left), AT_ONCE):
            some = left[at : at + AT_ONCE]
            out, here = verdicts(seen, view, middles[some], offsets, radius)
            outside[some] |= out
            open_[some] |= here
            bits[at : at + AT_ONCE] = here
        some = np.flatnonzero(bits)
        found.append((left[some], bits[some]))
    return Families(parents, side, open_ & ~outside, found)


def verdicts(
    seen: Silhouettes,
    view: int,
    middles: Float32[np.ndarray, "n 3"],
    offsets: Float32[np.ndarray, "8 3"],
    radius: np.float32,
) -> tuple[UInt8[np.ndarray, "n"], UInt8[np.ndarray, "n"]]:
    """Which of the balls of `radius` about `middles` + `offsets` are outside, which are open."""
    matrix = seen.projection[view]
    parent = middles @ matrix[:, :3].T + matrix[:, 3]
    child = offsets @ matrix[:, :3].T
    u, v, depth = (np.add.outer(parent[:, i], child[:, i]).ravel() for i in range(3))
    u /= depth
    v /= depth
    # outside: distance < -stretch * radius / (least depth in the ball)
    depth -= radius
    distance = bilinear(seen.distance[view], u, v) * depth
    reach = seen.stretch[view] * radius
    out = distance < -reach
    return np.packbits(out), np.packbits((distance <= reach) ^ out)
