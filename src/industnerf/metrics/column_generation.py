"""Column generation: which of ALL n x m pairs violate the dual constraints?

Dual potentials `u`, `v` prove a lower bound of the transport cost when no pair has a cost
c(a_i, b_j) below u_i + v_j.  Most pairs cost far more, so whole pairs of cells are skipped at once,
by two bounds for x in A, y in B.  The first is by the cells' radii:

    c(x, y) - u - v  >=  c(|c_A - c_B| - r_A - r_B) - max u - max v.

The second is by a tangent: c is convex in x - y, and no less than its tangent at d = c_A - c_B,

    c(x, y) - u - v  >=  c(d) + min [c'(d) (x - c_A) - u]  +  min [c'(d) (c_B - y) - v].

That loses nothing to the radii, and potentials vary as the tangent does: where clouds are far
apart, it skips nine in ten pairs that the first leaves.  Cells are tested in groups of neighbors,
and by the group's tangent one by one; only the rest are computed point by point.  Nothing is
estimated.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float64, Int64
from scipy.spatial.distance import cdist

from industnerf.metrics.cells import KdCells
from industnerf.metrics.ground_cost import GroundCost

# Rounding of the bounds above: a few times 2^-52 of lengths, and squares, of about 1 (see
# cells.normalize_clouds).
ROUNDING = 1e-13
GROUP = 4  # neighboring cells
CHUNK = 2**13  # pairs of groups, or of cells, at a time: a few MB


@dataclass(frozen=True)
class _PricedCells:
    """The cells of a cloud and their points' potentials.

    A pad has -inf, which makes its pairs' reduced cost infinite.
    """

    members: Int64[np.ndarray, "cells size"]  # whole groups; -1 pads
    points: Float64[np.ndarray, "cells size 3"]
    potentials: Float64[np.ndarray, "cells size"]

    @staticmethod
    def of(
        cells: KdCells, points: Float64[np.ndarray, "n 3"], potentials: Float64[np.ndarray, "n"]
    ) -> "_PricedCells":
        padding = ((0, -len(cells.members) % GROUP), (0, 0))
        members = np.pad(cells.members, padding, constant_values=-1)
        return _PricedCells(
            members, points[members], np.where(members < 0, -np.inf, potentials[members])
        )

    @cached_property
    def centers(self) -> Float64[np.ndarray, "groups 3"]:
        """The mean of each group's points."""
        is_member = (self.members >= 0).reshape(-1, GROUP * self.members.shape[1], 1)
        points = self.points.reshape(*is_member.shape[:2], 3)
        return (points * is_member).sum(axis=1) / is_member.sum(axis=1)

    @cached_property
    def offsets(self) -> Float64[np.ndarray, "3 groups width"]:
        """The group's points from its center; those of pads mean nothing."""
        points = self.points.reshape(len(self.centers), -1, 3)
        return np.ascontiguousarray(np.moveaxis(points - self.centers[:, None], 2, 0))

    @cached_property
    def radii(self) -> Float64[np.ndarray, "groups"]:
        """The largest distance of a member from the center."""
        lengths = np.sqrt(np.square(self.offsets).sum(axis=0))
        return np.where(self.members.reshape(lengths.shape) < 0, 0.0, lengths).max(axis=1)

    def least_along(
        self, groups: Int64[np.ndarray, "k"], slopes: Float64[np.ndarray, "k 3"]
    ) -> Float64[np.ndarray, "k group"]:
        """The least of slope * offset - potential in each cell of the group."""
        values = -self.potentials.reshape(len(self.centers), -1)[groups]
        for axis in range(3):
            values += self.offsets[axis][groups] * slopes[:, axis, None]
        return values.reshape(len(groups), GROUP, self.members.shape[1]).min(axis=2)


def violated_pairs(
    a: Float64[np.ndarray, "n 3"],
    b: Float64[np.ndarray, "m 3"],
    cells: tuple[KdCells, KdCells],
    potentials: tuple[Float64[np.ndarray, "n"], Float64[np.ndarray, "m"]],
    limit: float,
    ground: GroundCost,
) -> tuple[Int64[np.ndarray, "k"], Int64[np.ndarray, "k"], Float64[np.ndarray, "k"]]:
    """Every (i, j) whose reduced cost c(a_i, b_j) - u_i - v_j is below `limit`, and that cost."""
    side_a, side_b = (
        _PricedCells.of(*side) for side in zip(cells, (a, b), potentials, strict=True)
    )
    cell_a, cell_b = _candidate_cells(side_a, side_b, limit, ground)
    violations = []
    for start in range(0, max(len(cell_a), 1), CHUNK):  # at least once: an empty result has a shape
        p, q = cell_a[start : start + CHUNK], cell_b[start : start + CHUNK]
        reduced = ground.between_cells(side_a.points[p], side_b.points[q])
        reduced -= side_a.potentials[p][:, :, None]
        reduced -= side_b.potentials[q][:, None, :]
        # Faster than np.nonzero of three axes.
        k, s, t = np.unravel_index(np.flatnonzero(reduced < limit), reduced.shape)
        violations.append((side_a.members[p[k], s], side_b.members[q[k], t], reduced[k, s, t]))
    rows, cols, costs = (np.concatenate(part) for part in zip(*violations, strict=True))
    return rows, cols, costs


def _candidate_cells(
    side_a: _PricedCells, side_b: _PricedCells, limit: float, ground: GroundCost
) -> tuple[Int64[np.ndarray, "k"], Int64[np.ndarray, "k"]]:
    """Pairs of cells that neither bound rules out."""
    group_a, group_b = _candidate_groups(side_a, side_b, limit, ground)
    candidates = []
    for start in range(0, max(len(group_a), 1), CHUNK):
        p, q = group_a[start : start + CHUNK], group_b[start : start + CHUNK]
        cost, slope = ground.tangent(side_a.centers[p] - side_b.centers[q])
        least_a, least_b = side_a.least_along(p, slope), side_b.least_along(q, -slope)
        least_a += cost[:, None]
        bound = least_a[:, :, None] + least_b[:, None, :]
        k, s, t = np.unravel_index(np.flatnonzero(bound < limit + ROUNDING), bound.shape)
        candidates.append((GROUP * p[k] + s, GROUP * q[k] + t))
    cell_a, cell_b = (np.concatenate(part) for part in zip(*candidates, strict=True))
    return cell_a, cell_b


def _candidate_groups(
    side_a: _PricedCells, side_b: _PricedCells, limit: float, ground: GroundCost
) -> tuple[Int64[np.ndarray, "k"], Int64[np.ndarray, "k"]]:
    """Pairs of groups that their radii do not rule out."""
    bound = cdist(side_a.centers, side_b.centers)
    bound -= side_a.radii[:, None]
    bound -= side_b.radii
    bound = ground.lower_bound(bound)
    for side, axis in ((side_a, 1), (side_b, 0)):
        bound -= np.expand_dims(side.potentials.reshape(len(side.centers), -1).max(axis=1), axis)
    rows, cols = np.nonzero(bound < limit + ROUNDING)
    return rows, cols
