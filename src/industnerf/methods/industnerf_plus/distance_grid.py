"""Signed distances on a grid about the visual hull: where the surface is polished.

The grid is as fine as a budget of nodes allows in the part's own box, so a slender screw gets
smaller cells than a ball.  All lengths are in its cells; node (i, j, k) is at
`lo + spacing * (i, j, k)` in the unit frame.
"""

from dataclasses import dataclass
from itertools import cycle, islice, product

import numpy as np
import warp as wp
from jaxtyping import Float, Float32, Int32
from scipy.ndimage import binary_dilation, label, map_coordinates

from industnerf.errors import ReconstructionFailed
from industnerf.geometry.warp_launch import warp_device
from industnerf.methods.industnerf_plus import grid_kernels
from industnerf.photohull.voxel_grid import UnitFrameCameras, depth_in_hull

WIDTH = 12.0  # cells; distances are exact up to here
PADDING = 7  # cells about the hull
OUTSIDE = np.float32(3.0)  # cells; how far outside does not matter beyond it
GRID_RES_MULTIPLE = 8  # `depth_in_hull` doubles a grid three times
COARSE_RES = 64  # cells a side of the grid that the box is first measured on
MIN_GRID_RES, MAX_GRID_RES = 32, 256
MIN_CELL_PX = 1.0  # smaller cells show nothing more
HULL_SLACK_PX = 0.25  # a grid rounds edges off, and nothing could grow them again
EXACT_DEPTH = 1.2  # cells; the hull's own distances are exact up to here
FILL_LEVEL = 0.7  # cells; air shallower than this does not connect
FILL_VALUE = -1.5  # cells
MAX_SWEEPS = 64  # on a GPU; a CPU needs 8


@dataclass
class DistanceGrid:
    """Distances > 0 outside, and those of the visual hull, which they are never below."""

    distance: Float32[np.ndarray, "a b c"]
    hull: Float32[np.ndarray, "a b c"]
    lo: Float[np.ndarray, "3"]
    spacing: float

    def to_grid(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Points of the unit frame in cells."""
        return (points - self.lo) / self.spacing

    def from_grid(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Points in cells in the unit frame."""
        return self.lo + self.spacing * points

    def redistanced(self) -> "DistanceGrid":
        """The same surface, with exact distances, inside the hull."""
        distance = np.maximum(redistance(self.distance), self.hull)
        return DistanceGrid(distance, self.hull, self.lo, self.spacing)


def hull_grid(
    outlines: Float32[np.ndarray, "n h w"], rig: UnitFrameCameras, max_nodes: int
) -> DistanceGrid:
    """The visual hull, with about `max_nodes` nodes, but no cells below MIN_CELL_PX pixels.

    Raises ReconstructionFailed if the hull is empty.
    """
    outlines = outlines + np.float32(HULL_SLACK_PX)
    coarse = np.pad(depth_in_hull(outlines, rig, COARSE_RES), PADDING, constant_values=-OUTSIDE)
    grid_res = choose_grid_res(coarse, rig, max_nodes)
    # the part may touch the cube around the unit ball, the surface must not touch the grid's border
    depth = np.pad(depth_in_hull(outlines, rig, grid_res), PADDING, constant_values=-OUTSIDE)
    box = hull_box(depth)
    spacing = 2 / grid_res
    raw = -depth[tuple(slice(start, stop) for start, stop in box)]
    lo = np.array([(start - PADDING + 0.5) * spacing - 1 for start, _ in box])
    exact = redistance(raw)
    hull = np.where(np.abs(raw) < EXACT_DEPTH, raw, exact).astype(np.float32)
    return DistanceGrid(hull.copy(), hull, lo, spacing)


def choose_grid_res(
    coarse_depth: Float32[np.ndarray, "r r r"], rig: UnitFrameCameras, max_nodes: int
) -> int:
    """Cells a side of the cube around the unit ball, so that the hull's box has `max_nodes`.

    `coarse_depth` has COARSE_RES cells a side and PADDING on all sides.
    """
    extents = np.array([stop - start - 2 * PADDING for start, stop in hull_box(coarse_depth)])
    max_res = int(min(MAX_GRID_RES, rig.min_diameter_px / MIN_CELL_PX))
    candidates = range(MIN_GRID_RES, max(max_res, MIN_GRID_RES) + 1, GRID_RES_MULTIPLE)
    return max(
        (
            grid_res
            for grid_res in candidates
            if np.prod(extents * grid_res / COARSE_RES + 2 * PADDING) <= max_nodes
        ),
        default=MIN_GRID_RES,
    )


def hull_box(depth: Float32[np.ndarray, "r r r"]) -> list[tuple[int, int]]:
    """First and last cell of each axis, of the box of the hull with its padding."""
    if not (depth > -1).any():
        raise ReconstructionFailed(
            "the silhouettes of the views have nothing in common: do the cameras belong to these "
            "photographs, and is the background's color right?"
        )
    box = []
    for axis in range(3):
        others = tuple(other for other in range(3) if other != axis)
        inside = np.flatnonzero((depth > -1).any(axis=others))
        box.append(
            (max(0, int(inside[0]) - PADDING), min(len(depth), int(inside[-1]) + 1 + PADDING))
        )
    return box


def from_points(
    grid: DistanceGrid,
    points: Float32[np.ndarray, "m 3"],
    distance: Float32[np.ndarray, "m"],
    spacing: float,
) -> DistanceGrid:
    """The surface that the signed distances of points on a grid of `spacing` have.

    It snaps to the hull where it is within a cell of it, and enclosed air is filled: no view
    can have shown it.  Distances are in the unit frame.
    """
    lo = points.min(axis=0) - 2 * spacing
    index = np.round((points - lo) / spacing).astype(int)
    coarse = np.full(index.max(axis=0) + 3, 3.0, np.float32)
    coarse[tuple(index.T)] = np.clip(distance / spacing, -3, 3)
    axes = [grid.lo[a] + grid.spacing * np.arange(n) for a, n in enumerate(grid.hull.shape)]
    coordinates = np.meshgrid(*[(x - lo[a]) / spacing for a, x in enumerate(axes)], indexing="ij")
    values = map_coordinates(coarse, coordinates, order=1, mode="nearest") * np.float32(
        spacing / grid.spacing
    )
    values = snap_to_hull(values, grid.hull)
    values = fill_enclosed_air(np.maximum(values, grid.hull))
    return DistanceGrid(values, grid.hull, grid.lo, grid.spacing).redistanced()


def snap_to_hull(
    values: Float32[np.ndarray, "a b c"], hull: Float32[np.ndarray, "a b c"], margin: float = 1.0
) -> Float32[np.ndarray, "a b c"]:
    """What is within `margin` of the hull is on it; the next `margin` is stretched."""
    gap = np.maximum(values - hull, 0)
    gap = np.where(gap < 2 * margin, np.maximum(0, 2 * (gap - margin)), gap)
    return np.where(hull > -6, hull + gap, values).astype(np.float32)


def fill_enclosed_air(values: Float32[np.ndarray, "a b c"]) -> Float32[np.ndarray, "a b c"]:
    """Make air solid that is not connected to the outside."""
    regions = label(values > FILL_LEVEL)[0]
    outside = binary_dilation(regions == regions[0, 0, 0], np.ones((3, 3, 3)))
    return np.where((values > 0) & ~outside, FILL_VALUE, values).astype(np.float32)


def redistance(
    values: Float32[np.ndarray, "a b c"], width: float = WIDTH
) -> Float32[np.ndarray, "a b c"]:
    """Signed distances (cells) from the zero set of `values`, up to `width`."""
    device = warp_device()
    source = wp.array(np.ascontiguousarray(values, np.float32), dtype=wp.float32, device=device)
    distance = wp.empty(values.shape, wp.float32, device=device)
    is_fixed = wp.empty(values.shape, wp.uint8, device=device)
    wp.launch(
        grid_kernels.start_near_zero,
        values.shape,
        [source],
        [distance, is_fixed],
        device=device,
    )
    num_changed = wp.zeros(1, wp.int32, device=device)
    for number, reverse in enumerate(islice(cycle(product((0, 1), repeat=3)), MAX_SWEEPS)):
        wp.launch(
            grid_kernels.sweep,
            values.shape[:2],
            [distance, is_fixed, wp.vec3i(*reverse), width, num_changed],
            device=device,
        )
        if number % 8 == 7:
            if not distance.device.is_cuda or num_changed.numpy()[0] == 0:
                break
            num_changed.zero_()
    magnitude = np.minimum(distance.numpy(), np.float32(width))
    return np.where(values > 0, magnitude, -magnitude).astype(np.float32)


def band_nodes(distance: Float32[np.ndarray, "a b c"], width: float) -> Int32[np.ndarray, "m 3"]:
    """The nodes within `width` cells of the surface, but for those at the border."""
    inner = np.abs(distance[2:-2, 2:-2, 2:-2]) < width
    return (np.argwhere(inner) + 2).astype(np.int32)


def node_neighbors(
    nodes: Int32[np.ndarray, "m 3"], shape: tuple[int, ...]
) -> Int32[np.ndarray, "m 6"]:
    """The numbers of the six neighbors of each node; -1: not among them."""
    number = np.full(shape, -1, np.int32)
    number[tuple(nodes.T)] = np.arange(len(nodes), dtype=np.int32)
    i, j, k = nodes.T
    return np.stack(
        [
            number[i + 1, j, k],
            number[i - 1, j, k],
            number[i, j + 1, k],
            number[i, j - 1, k],
            number[i, j, k + 1],
            number[i, j, k - 1],
        ],
        axis=1,
    )
