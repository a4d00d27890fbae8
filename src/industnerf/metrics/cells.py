"""Clouds of weighted points, and their division into small cells by a k-d tree.

One division serves twice: the cells' centroids are the next coarser cloud, and all points of a cell
are bounded at once.  Neighboring cells are near each other.  Cells are padded to one width: where a
cell has fewer points, `members` is -1.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.errors import MetricError

CELL_SIZE = 4


@dataclass(frozen=True)
class WeightedCloud:
    points: Float64[np.ndarray, "n 3"]
    mass: Float64[np.ndarray, "n"]  # whole numbers, so that sums and flows are exact


@dataclass(frozen=True)
class KdCells:
    order: Int64[np.ndarray, "n"]  # points of the cloud, cell after cell
    members: Int64[np.ndarray, "cells size"]  # -1 pads
    coarse: WeightedCloud  # centroid and mass of each cell


def normalize_clouds(
    a: Float64[np.ndarray, "n 3"], b: Float64[np.ndarray, "m 3"]
) -> tuple[WeightedCloud, WeightedCloud, float]:
    """Both clouds around the origin, their longest side in [1/2, 1), and the unit taken out.

    Equal weights in each, equal sums.  The unit is a power of two: scaling rounds nothing.
    """
    low, high = np.minimum(a.min(axis=0), b.min(axis=0)), np.maximum(a.max(axis=0), b.max(axis=0))
    with np.errstate(over="ignore"):
        center, extent = low / 2 + high / 2, float(np.max(high - low))
    if not math.isfinite(extent):
        raise MetricError(f"the clouds extend from {low} to {high}: too far for float64")
    unit, divisor = math.ldexp(1.0, math.frexp(extent)[1]), math.gcd(len(a), len(b))
    left = WeightedCloud((a - center) / unit, np.full(len(a), float(len(b) // divisor)))
    right = WeightedCloud((b - center) / unit, np.full(len(b), float(len(a) // divisor)))
    return left, right, unit


def kd_cells(cloud: WeightedCloud) -> KdCells:
    """Halve along the longest side, ever again, down to cells of at most `CELL_SIZE` points."""
    order, sizes = np.arange(len(cloud.points)), np.array([len(cloud.points)])
    while sizes.max() > CELL_SIZE:
        order = _sort_groups(cloud.points, order, sizes)
        halves = np.stack([(sizes + 1) // 2, sizes // 2], axis=1).ravel()
        sizes = halves[halves > 0]
    return _build_cells(cloud, order, sizes)


def _sort_groups(
    points: Float64[np.ndarray, "n 3"], order: Int64[np.ndarray, "n"], sizes: Int64[np.ndarray, "g"]
) -> Int64[np.ndarray, "n"]:
    """Sort every group of `order` along its own longest side; ties keep their order."""
    starts, group = np.cumsum(sizes) - sizes, np.repeat(np.arange(len(sizes)), sizes)
    ordered = points[order]
    sides = np.maximum.reduceat(ordered, starts) - np.minimum.reduceat(ordered, starts)
    coordinate = ordered[np.arange(len(order)), sides.argmax(axis=1)[group]]
    return order[np.lexsort((coordinate, group))]


def _build_cells(
    cloud: WeightedCloud, order: Int64[np.ndarray, "n"], sizes: Int64[np.ndarray, "cells"]
) -> KdCells:
    starts, cell = np.cumsum(sizes) - sizes, np.repeat(np.arange(len(sizes)), sizes)
    members = np.full((len(sizes), sizes.max()), -1)
    members[cell, np.arange(len(order)) - starts[cell]] = order
    points, mass = cloud.points[order], cloud.mass[order]
    total = np.add.reduceat(mass, starts)
    center = np.add.reduceat(points * mass[:, None], starts) / total[:, None]
    return KdCells(order, members, WeightedCloud(center, total))
