"""Sweeps: what the photographs contradict is taken off, until they contradict nothing more.

A surface cell is consistent if there is a colour that its views can agree on: one within the
range that each of them shows across the cell's footprint (the r-consistency of Kutulakos, 2000).
Only views count that look at the cell nearly straight and unhidden; a convex edge shows its two
faces to different views, but both of them to those.  What is hidden now may be seen later.  All
cells of a sweep are judged before any of them is taken off, so that their order does not matter.
"""

from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, Int32, UInt8

from industnerf.geometry.cellwise import handed, told
from industnerf.photohull.lattice import UNKNOWN, Rig
from industnerf.schema import SpaceCarvingSettings

WHOLE_EVERY = 8  # sweeps; those between look only where the one before took something off
DONE = 1e-3  # share of the surface that a whole sweep may still take off
STEPS = np.indices((3, 3, 3)).reshape(3, -1).T - 1
MOST = 0.12  # that the gap of a cell may say to its neighbours; or twice the threshold

Cells = Int32[np.ndarray, "_"]


def ranges(
    rgb: UInt8[np.ndarray, "n h w 3"], width: int
) -> tuple[UInt8[np.ndarray, "n h w 3"], UInt8[np.ndarray, "n h w 3"]]:
    """The least and the largest value of each channel in a square of `width` px about each pixel.

    Of an even width, the pixel is the first behind the middle.
    """
    before = width // 2
    rim = [(0, 0), (before, width - 1 - before), (before, width - 1 - before), (0, 0)]
    both = []
    for extreme in (np.minimum, np.maximum):
        image = np.pad(rgb, rim, mode="edge")
        for axis in (1, 2):
            here, kept = [slice(None)] * 4, rgb.shape[axis]
            here[axis] = slice(kept)
            best = image[tuple(here)].copy()
            for step in range(1, width):
                here[axis] = slice(step, step + kept)
                extreme(best, image[tuple(here)], out=best)
            image = best
        both.append(image)
    return both[0], both[1]


class Sweeper:
    """The solid, and what the photographs say of it."""

    def __init__(
        self,
        solid: Bool[np.ndarray, "r r r"],
        rgb: UInt8[np.ndarray, "n h w 3"],
        rig: Rig,
        settings: SpaceCarvingSettings,
    ) -> None:
        import warp as wp

        from industnerf.photohull import kernels

        self._side, self._threshold = len(solid), settings.threshold
        self._solid = solid.astype(np.uint8)
        self._gap = np.full(solid.shape, UNKNOWN)
        width = max(1, round(settings.footprint * rig.px_across / self._side))
        darkest, brightest = ranges(rgb, width)
        self._photographs = [
            handed(darkest, wp.uint8),
            handed(brightest, wp.uint8),
            handed(rig.projection, kernels.mat34),
            handed(rig.eyes, wp.vec3),
            self._rules(settings),
        ]

    def _rules(self, settings: SpaceCarvingSettings) -> Any:
        from industnerf.photohull import kernels

        rules = kernels.Rules()
        for name, end in (("lo", 0), ("hi", 1)):
            corner = [
                np.flatnonzero(self._solid.any(axis=a))[-end] for a in ((1, 2), (0, 2), (0, 1))
            ]
            setattr(rules, name, (np.array(corner) + end) * (2 / self._side) - 1)
        rules.facing, rules.outliers = settings.facing, settings.outliers
        rules.views = settings.views
        return rules

    def carved(self, sweeps: int) -> Bool[np.ndarray, "r r r"]:
        """What is left of the solid after at most so many sweeps."""
        whole = True
        for sweep in range(sweeps):
            cells = exposed(self._solid) if whole else self._beside(taken)
            taken = self._sweep(cells)
            if whole and len(taken) <= DONE * len(cells):
                break
            whole = (sweep + 1) % WHOLE_EVERY == 0 or not len(taken)
        return self._solid > 0

    def _sweep(self, cells: Cells) -> Cells:
        """Take off those of `cells` that are inconsistent, and return them."""
        import warp as wp

        from industnerf.photohull import kernels

        self._gap.ravel()[cells] = self.gaps(cells)
        gap, most = handed(self._gap, wp.float32), max(MOST, 2 * self._threshold)
        smooth = self._of_cells(kernels.smooth_gap, cells, gap, most)
        taken = cells[smooth > self._threshold]
        self._solid.ravel()[taken] = 0
        return taken

    def gaps(self, cells: Cells) -> Float32[np.ndarray, "_"]:
        """By how much no colour suits all views of each cell; UNKNOWN where too few see it."""
        from industnerf.photohull import kernels

        return self._of_cells(kernels.measure_gap, cells, *self._photographs)

    def _of_cells(self, kernel: Any, cells: Cells, *inputs: Any) -> Float32[np.ndarray, "_"]:
        """What `kernel` says of each cell of the solid as it is now."""
        import warp as wp

        return told(kernel, cells, handed(self._solid, wp.uint8), *inputs)

    def _beside(self, taken: Cells) -> Cells:
        """The surface cells among the 26 about each of `taken`; none at the rim."""
        side = self._side
        place = np.stack(np.unravel_index(taken, self._solid.shape), axis=1)
        about = (place[:, None] + STEPS).reshape(-1, 3)
        core = ((about > 0) & (about < side - 1)).all(axis=1)
        near = np.unique((about[core] @ [side * side, side, 1]).astype(np.int32))
        near = near[self._solid.ravel()[near] > 0]
        at = np.stack(np.unravel_index(near, self._solid.shape))
        bare = np.zeros(len(near), bool)
        for axis in range(3):
            for step in (-1, 1):
                there = at.copy()
                there[axis] += step
                bare |= self._solid[tuple(there)] == 0
        return near[bare]


def exposed(solid: UInt8[np.ndarray, "r r r"]) -> Cells:
    """Flat indices of the solid cells that share a face with one that is not; none at the rim."""
    core = solid[1:-1, 1:-1, 1:-1]
    buried = core.copy()
    for axis in range(3):
        for step in (0, 2):
            beside = [slice(1, -1)] * 3
            beside[axis] = slice(step, step + core.shape[axis])
            buried &= solid[tuple(beside)]
    place = np.argwhere(core > buried) + 1
    return (place @ [solid.shape[1] * solid.shape[2], solid.shape[2], 1]).astype(np.int32)
