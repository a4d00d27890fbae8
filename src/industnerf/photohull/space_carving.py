"""Space carving: surface cells that the photographs contradict are removed, sweep by sweep.

A surface cell is consistent if there is a color that its views can agree on: one within the
range that each of them shows across the cell's footprint (the r-consistency of Kutulakos, 2000).
Only views count that see the cell nearly straight and unoccluded; both faces of a convex edge are
in the footprint of those.  What is occluded now may be seen later.  All cells of a sweep are
measured before any of them is removed, so that their order does not matter.
"""

from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, Int32, UInt8

from industnerf.geometry.warp_launch import launch, to_warp
from industnerf.photohull.voxel_grid import UNKNOWN, UnitFrameCameras
from industnerf.schema import SpaceCarvingSettings

FULL_SWEEP_INTERVAL = 8  # sweeps; those between visit only neighbors of what was just removed
CONVERGED_SHARE = 1e-3  # share of the surface; a full sweep that removes less is the last
NEIGHBOR_OFFSETS = np.indices((3, 3, 3)).reshape(3, -1).T - 1
MAX_NEIGHBOR_GAP = 0.12  # of a cell, in the mean of its neighbors; or twice the threshold

CellIndices = Int32[np.ndarray, "_"]


def color_ranges(
    rgb: UInt8[np.ndarray, "n h w 3"], width: int
) -> tuple[UInt8[np.ndarray, "n h w 3"], UInt8[np.ndarray, "n h w 3"]]:
    """Minimum and maximum of each channel in a square of `width` px about each pixel.

    Of an even width, the pixel is the first after the middle.
    """
    before = width // 2
    padding = [(0, 0), (before, width - 1 - before), (before, width - 1 - before), (0, 0)]
    extremes_per_channel = []
    for extreme in (np.minimum, np.maximum):
        image = np.pad(rgb, padding, mode="edge")
        for axis in (1, 2):
            window, size = [slice(None)] * 4, rgb.shape[axis]
            window[axis] = slice(size)
            best = image[tuple(window)].copy()
            for step in range(1, width):
                window[axis] = slice(step, step + size)
                extreme(best, image[tuple(window)], out=best)
            image = best
        extremes_per_channel.append(image)
    return extremes_per_channel[0], extremes_per_channel[1]


class SpaceCarver:
    """The solid, and how far photographs contradict its surface cells."""

    def __init__(
        self,
        solid: Bool[np.ndarray, "r r r"],
        rgb: UInt8[np.ndarray, "n h w 3"],
        rig: UnitFrameCameras,
        settings: SpaceCarvingSettings,
    ) -> None:
        import warp as wp

        from industnerf.photohull import kernels

        self._side, self._threshold = len(solid), settings.color_threshold
        self._solid = solid.astype(np.uint8)
        self._gap = np.full(solid.shape, UNKNOWN)
        width = max(1, round(settings.voxel_footprint * rig.min_diameter_px / self._side))
        darkest, brightest = color_ranges(rgb, width)
        self._view_inputs = [
            to_warp(darkest, wp.uint8),
            to_warp(brightest, wp.uint8),
            to_warp(rig.projection, kernels.mat34),
            to_warp(rig.camera_centers, wp.vec3),
            self._params(settings),
        ]

    def _params(self, settings: SpaceCarvingSettings) -> Any:
        from industnerf.photohull import kernels

        params = kernels.CarvingParams()
        for name, end in (("lo", 0), ("hi", 1)):
            corner = [
                np.flatnonzero(self._solid.any(axis=a))[-end] for a in ((1, 2), (0, 2), (0, 1))
            ]
            setattr(params, name, (np.array(corner) + end) * (2 / self._side) - 1)
        params.min_facing_cosine, params.outlier_share = (
            settings.min_view_cosine,
            settings.outlier_fraction,
        )
        params.min_views = settings.min_views
        return params

    def carve(self, sweeps: int) -> Bool[np.ndarray, "r r r"]:
        """What is left of the solid after at most so many sweeps."""
        is_full_sweep = True
        for sweep in range(sweeps):
            cells = (
                surface_voxels(self._solid) if is_full_sweep else self._surface_neighbors(removed)
            )
            removed = self._sweep(cells)
            if is_full_sweep and len(removed) <= CONVERGED_SHARE * len(cells):
                break
            is_full_sweep = (sweep + 1) % FULL_SWEEP_INTERVAL == 0 or not len(removed)
        return self._solid > 0

    def _sweep(self, cells: CellIndices) -> CellIndices:
        """Remove those of `cells` that are inconsistent, and return them."""
        import warp as wp

        from industnerf.photohull import kernels

        self._gap.ravel()[cells] = self.color_gaps(cells)
        gap, max_gap = to_warp(self._gap, wp.float32), max(MAX_NEIGHBOR_GAP, 2 * self._threshold)
        smooth = self._launch(kernels.smooth_color_gap, cells, gap, max_gap)
        removed = cells[smooth > self._threshold]
        self._solid.ravel()[removed] = 0
        return removed

    def color_gaps(self, cells: CellIndices) -> Float32[np.ndarray, "_"]:
        """By how much no color suits all views of each cell; UNKNOWN where too few see it."""
        from industnerf.photohull import kernels

        return self._launch(kernels.measure_color_gap, cells, *self._view_inputs)

    def _launch(self, kernel: Any, cells: CellIndices, *inputs: Any) -> Float32[np.ndarray, "_"]:
        """The output of `kernel` for each cell of the solid as it is now."""
        import warp as wp

        return launch(kernel, cells, to_warp(self._solid, wp.uint8), *inputs)

    def _surface_neighbors(self, removed: CellIndices) -> CellIndices:
        """The surface cells among the 26 about each of `removed`; none at the border."""
        side = self._side
        index = np.stack(np.unravel_index(removed, self._solid.shape), axis=1)
        neighbors = (index[:, None] + NEIGHBOR_OFFSETS).reshape(-1, 3)
        is_interior = ((neighbors > 0) & (neighbors < side - 1)).all(axis=1)
        candidates = np.unique((neighbors[is_interior] @ [side * side, side, 1]).astype(np.int32))
        candidates = candidates[self._solid.ravel()[candidates] > 0]
        candidate_index = np.stack(np.unravel_index(candidates, self._solid.shape))
        is_surface = np.zeros(len(candidates), bool)
        for axis in range(3):
            for step in (-1, 1):
                shifted = candidate_index.copy()
                shifted[axis] += step
                is_surface |= self._solid[tuple(shifted)] == 0
        return candidates[is_surface]


def surface_voxels(solid: UInt8[np.ndarray, "r r r"]) -> CellIndices:
    """Flat indices of solid cells that share a face with one that is not; none at the border."""
    interior = solid[1:-1, 1:-1, 1:-1]
    enclosed = interior.copy()
    for axis in range(3):
        for step in (0, 2):
            window = [slice(1, -1)] * 3
            window[axis] = slice(step, step + interior.shape[axis])
            enclosed &= solid[tuple(window)]
    index = np.argwhere(interior > enclosed) + 1
    return (index @ [solid.shape[1] * solid.shape[2], solid.shape[2], 1]).astype(np.int32)
