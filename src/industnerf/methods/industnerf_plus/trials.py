"""Changes of the surface on trial: how much more, or less, it then looks like the photographs."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import warp as wp
from jaxtyping import Float32, Int64
from scipy.ndimage import binary_dilation

from industnerf.methods.industnerf_plus import grid_kernels
from industnerf.methods.industnerf_plus.appearance import pixel_lattice
from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.shaded_surface import (
    PinholeRays,
    ShadedSurface,
    launch,
    to_device,
)

BETA = 0.3  # cells
PIXEL_STEP = 4  # every so many pixels in both directions judge a change
EDGE_WEIGHT = 0.3  # of pixels beside edges, where a rim half a cell off already misleads
MAX_RESIDUAL = 0.2
UNCOVERED_RESIDUAL = 1.0  # of a pixel that shows the part, where there is none
MIN_FLIPS = 6  # nodes that change sides, and pixels that change
MIN_CHANGE = 0.02  # cells
HIT_MARGIN = 0.7  # cells; a soft surface is hit before it is reached
NOWHERE = np.float32(-1e3)  # in no box


@dataclass(frozen=True)
class Change:
    """Nodes (n, 3), with their distances before and after, in cells."""

    nodes: Int64[np.ndarray, "n 3"]
    before: Float32[np.ndarray, "n"]
    after: Float32[np.ndarray, "n"]

    @staticmethod
    def of(
        nodes: Int64[np.ndarray, "n 3"],
        before: Float32[np.ndarray, "n"],
        after: Float32[np.ndarray, "n"],
    ) -> "Change | None":
        """What of it changes anything; None where too few nodes change sides."""
        if np.count_nonzero((after > 0) != (before > 0)) < MIN_FLIPS:
            return None
        is_changed = np.abs(after - before) > MIN_CHANGE
        return Change(nodes[is_changed], before[is_changed], after[is_changed])


@dataclass(frozen=True)
class Verdict:
    """What the pixels that a change may alter cost without it and with it."""

    before: float
    after: float

    @property
    def gain(self) -> float:
        """How much less they cost."""
        return self.before - self.after


class Trials:
    """The surface, and a lattice of pixels that judge its changes.

    `points` (cells) are where their rays end, `ends` (cells) how far that is, < 0 where nowhere;
    `lattice_index` is where each is on a lattice of `lattice_shape`.
    """

    def __init__(self, surface: ShadedSurface, rays: PinholeRays, pictures: Pictures) -> None:
        self.surface, self.rays, self.pictures = surface, rays, pictures
        self.number = 0
        surface.update_band(BETA)
        self.distance = surface.distance.numpy().copy()
        pixels = pixel_lattice(len(rays.centers), rays.height, rays.width, PIXEL_STEP)
        self.pixels = pixels[pictures.is_inside(pixels)]
        view, in_view = np.divmod(self.pixels, rays.height * rays.width)
        row, column = np.divmod(in_view, rays.width)
        self.lattice_index = view, row // PIXEL_STEP, column // PIXEL_STEP
        self.lattice_shape = (
            len(rays.centers),
            -(-rays.height // PIXEL_STEP),
            -(-rays.width // PIXEL_STEP),
        )
        self._weight = np.where(pictures.is_edge(self.pixels), EDGE_WEIGHT, 1.0)
        self.directions = rays.directions(self.pixels).astype(np.float32)
        self.origins = rays.centers.astype(np.float32)[self.pixels // (rays.width * rays.height)]
        every = np.arange(len(self.pixels))
        self._cost, self.ends = self._look(every)
        self.points = self._end_points(every)

    def render(self, pixels):
        """Brightness of pixels, and how far their rays go (cells, -1: no surface)."""
        rendered = self.surface.render(self.rays, pixels, self.pictures.gray_background, BETA)
        return rendered.color.numpy()[:, 0], rendered.hit.numpy()

    def _look(self, chosen: Int64[np.ndarray, "n"]):
        """Cost and end of the chosen ones of the judging pixels."""
        color, end = self.render(self.pixels[chosen])
        residual = np.abs(color - self.pictures.gray[self.pixels[chosen]])
        residual = np.where(end > 0, np.minimum(residual, MAX_RESIDUAL), UNCOVERED_RESIDUAL)
        return self._weight[chosen] * residual, end.copy()

    def _end_points(self, chosen: Int64[np.ndarray, "n"]) -> Float32[np.ndarray, "n 3"]:
        end = self.ends[chosen, None]
        return np.where(end > 0, self.origins[chosen] + end * self.directions[chosen], NOWHERE)

    def ending_in(
        self,
        lo: Int64[np.ndarray, "3"],
        hi: Int64[np.ndarray, "3"],
        inside: Callable[[Float32[np.ndarray, "n 3"]], Float32[np.ndarray, "n"]],
        most: int,
    ) -> Int64[np.ndarray, "n"]:
        """Judging pixels whose rays end in a box, where `inside` is not clearly negative.

        It is asked for at most about `most` of them.
        """
        ending = every_nth(in_box(self.points, lo, hi), most)
        return ending[inside(self.points[ending]) > -HIT_MARGIN]

    def attempt(
        self, change: Change, chosen: Int64[np.ndarray, "n"], max_cost_ratio: float, keep: bool
    ) -> Verdict | None:
        """The verdict of the chosen pixels; None where they are too few, or not clearly for it.

        With `keep` the change stays, if they are for it.
        """
        if len(chosen) < MIN_FLIPS:
            return None
        self.number += 1
        near = self._gradient_nodes(change.nodes[np.abs(change.after) < BETA * 4 + 2])
        self._set(change.nodes, change.after, near)
        cost, end = self._look(chosen)
        verdict = Verdict(float(self._cost[chosen].sum()), float(cost.sum()))
        is_better = verdict.after < max_cost_ratio * verdict.before
        if keep and is_better:
            self._cost[chosen], self.ends[chosen] = cost, end
            self.points[chosen] = self._end_points(chosen)
        else:
            self._set(change.nodes, change.before, near)
        return verdict if is_better else None

    def apply(self, change: Change) -> None:
        """Make a change that no judging pixel can see."""
        self._set(change.nodes, change.after, self._gradient_nodes(change.nodes))

    def _set(self, nodes, values, near) -> None:
        self.distance[tuple(nodes.T)] = values
        launch(
            grid_kernels.scatter,
            len(nodes),
            to_device(nodes, wp.vec3i),
            to_device(values),
            self.surface.distance,
        )
        self.surface.update_gradient(near)

    def _gradient_nodes(self, nodes):
        """The nodes, and their neighbors."""
        if not len(nodes):
            return to_device(nodes, wp.vec3i)
        lo = nodes.min(axis=0) - 1
        mask = np.zeros(nodes.max(axis=0) - lo + 2, bool)
        mask[tuple((nodes - lo).T)] = True
        return to_device(np.argwhere(binary_dilation(mask)) + lo, wp.vec3i)


def in_box(
    points: Float32[np.ndarray, "n 3"], lo: Int64[np.ndarray, "3"], hi: Int64[np.ndarray, "3"]
) -> Int64[np.ndarray, "m"]:
    """Indices of the points in a box or less than a cell before it."""
    chosen = np.arange(len(points))
    for axis in range(3):  # each leaves fewer to the next
        column = points[chosen, axis]
        chosen = chosen[(column > lo[axis] - 1) & (column < hi[axis])]
    return chosen


def every_nth(values: Int64[np.ndarray, "n"], most: int) -> Int64[np.ndarray, "m"]:
    """Every so many values, so that at most about `most` are left."""
    return values[:: len(values) // most + 1]
