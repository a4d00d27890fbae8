"""Multiresolution isosurface extraction: a field evaluated only near its level set.

Mescheder et al., "Occupancy Networks" (2019), section 3.3.  A cell of a coarse lattice with some
points above the level and some below is divided in eight, and so on; elsewhere the values
of its corners stand for all.  Where a fine point contradicts a cell beside it, that is divided too.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float, Int

# Values at lattice points, given as (i, j, k) of the finest lattice.
Field = Callable[[Int[np.ndarray, "p 3"]], Float[np.ndarray, "p"]]
Values = Float[np.ndarray, "n n n"]
Known = Bool[np.ndarray, "n n n"]
THIRDS = slice(None, -1, 2), slice(1, None, 2), slice(2, None, 2)  # points of cells along an axis


def mise(
    field: Field, choose_level: Callable[[Values], float], cells: int, subdivisions: int
) -> tuple[Values, float, int]:
    """Values at the (cells * 2^subdivisions + 1)^3 lattice points, the level, and the cost.

    The level is chosen from the values of the coarse lattice; the cost is how many points were
    evaluated.  The values cross the level exactly where those of `field` do, but for what is missed
    on all points of a coarse lattice of `cells`^3: islands and holes smaller than a cell of it.
    """
    stride = 2**subdivisions
    values, known = np.zeros((cells + 1,) * 3), np.zeros((cells + 1,) * 3, bool)
    _evaluate(field, stride, values, known, ~known)
    level = choose_level(values)
    for _ in range(subdivisions):
        stride //= 2
        values, known = _upsampled(values), _upsampled_mask(known)
        while (needed := _cell_points(_active_cells(values > level)) & ~known).any():
            _evaluate(field, stride, values, known, needed)
    return values, level, int(known.sum())


def _evaluate(field: Field, stride: int, values: Values, known: Known, needed: Known) -> None:
    values[needed] = field(stride * np.argwhere(needed))
    known |= needed


def _upsampled(values: Values) -> Float[np.ndarray, "m m m"]:
    """Twice as fine; a new point has the value of a corner of the cell that it is in."""
    for axis in range(3):
        values = values.repeat(2, axis)
    return values[:-1, :-1, :-1]


def _upsampled_mask(known: Known) -> Bool[np.ndarray, "m m m"]:
    """Twice as fine; no new point is known."""
    fine = np.zeros([2 * n - 1 for n in known.shape], bool)
    fine[::2, ::2, ::2] = known
    return fine


def _active_cells(above: Bool[np.ndarray, "m m m"]) -> Bool[np.ndarray, "c c c"]:
    """Cells of 3^3 points, sharing their faces, of which some are above and some not."""
    any_above = all_above = above
    for axis in range(3):
        any_above = np.any([np.moveaxis(any_above, axis, 0)[third] for third in THIRDS], axis=0)
        all_above = np.all([np.moveaxis(all_above, axis, 0)[third] for third in THIRDS], axis=0)
        any_above, all_above = np.moveaxis(any_above, 0, axis), np.moveaxis(all_above, 0, axis)
    return any_above & ~all_above


def _cell_points(cells: Bool[np.ndarray, "c c c"]) -> Bool[np.ndarray, "m m m"]:
    """The 3^3 points of every cell."""
    for axis in range(3):
        points = np.zeros([n + (i == axis) * (n + 1) for i, n in enumerate(cells.shape)], bool)
        along = np.moveaxis(points, axis, 0)
        for third in THIRDS:
            along[third] |= np.moveaxis(cells, axis, 0)
        cells = points
    return cells
