"""A surface inside the visual hull, for `industnerf_plus`: points hold distances, not densities.

Every point starts at its signed distance from the hull, or from the photo hull, so that the first
surface is theirs, and is soft: light reaches far inside.  While it hardens, what the images
contradict is carved.  Deep inside the photo hull all points start alike (`start.deepest`): a point
that started at its true depth would have to be carved through all of it.

    carved = max(0, distance - that of the hull)

Inside, a point may be `slack` times as deep as the hull has it, which is carved by nothing.

Of a plain face most images contradict neither the face nor a hollow in it: what nothing keeps
carving falls back to where it started; faster, if the photographs are not believed (`photohull`).
Such hollows are shallow.  What is carved deeper inside the visual hull than `back_within` stays
carved: it is a pocket.

An addition to the paper, after VolSDF -- Yariv et al. (2021).  Lengths are in spacings of the
first level.
"""

import torch
from jaxtyping import Float32, Int64
from torch import Tensor

from industnerf.schema import SdfSettings

HULL_MARGIN = 2.0  # of the level's own, beyond the hull: points needed there to say where it ends
MAX_ABS_SDF = 9.0  # distances are kept within this: nothing is learned from larger ones


class SdfConstraints:
    """The constraints that distances on a grid learn under."""

    def __init__(
        self,
        hull_distance: Float32[Tensor, "m"],
        neighbors: Int64[Tensor, "m 6"],
        settings: SdfSettings,
        initial_distance: Float32[Tensor, "m"] | None = None,
        is_reliable: bool = True,
    ) -> None:
        self.hull_distance, self._neighbors, self._settings = hull_distance, neighbors, settings
        self._relax_rate = (
            settings.relax_rate if is_reliable else settings.relax_rate_low_confidence
        )
        initial_distance = (
            hull_distance
            if initial_distance is None
            else initial_distance.clamp(-settings.init.initial_max_depth, MAX_ABS_SDF)
        )
        self._initial_distance = torch.maximum(initial_distance, hull_distance)
        self._is_shallow = hull_distance >= -settings.relax_max_depth
        self._min_distance = torch.where(
            hull_distance > 0, hull_distance, hull_distance * settings.max_depth_factor
        )

    def lr(self, beta: float) -> float:
        """Of Adam: a soft surface may move far."""
        return self._settings.lr * beta

    def initial_sdf(self, distance: Float32[Tensor, "m"] | None) -> Float32[Tensor, "m"]:
        """To start from: the start's distances, or `distance` and nowhere deeper than the hull."""
        return (
            self._initial_distance
            if distance is None
            else torch.maximum(distance, self.hull_distance)
        )

    @torch.no_grad()
    def relax_to_initial(self, distance: Float32[Tensor, "m"], lr: float) -> None:
        """Of what was carved near the hull a little is undone: a share of a step at `rate`."""
        relaxed = torch.maximum(distance - self._relax_rate * lr, self._initial_distance)
        is_relaxed = (distance > self._initial_distance) & self._is_shallow
        distance.copy_(torch.where(is_relaxed, relaxed, distance))

    @torch.no_grad()
    def constrain(self, distance: Float32[Tensor, "m"], steps_done: int, steps: int) -> None:
        """Back inside the hull; now and then, and at the end, without pits."""
        distance.copy_(torch.maximum(distance, self._min_distance)).clamp_(
            -MAX_ABS_SDF, MAX_ABS_SDF
        )
        if self._is_filter_step(steps_done, steps):
            distance.copy_(median_filter(distance, self.hull_distance, self._neighbors))

    def _is_filter_step(self, steps_done: int, steps: int) -> bool:
        """Whether pits are filled after so many of the `steps`."""
        interval = self._settings.median_filter_interval
        if not interval:
            return False
        return steps_done == steps or (
            steps_done % interval == 0 and steps_done >= self._settings.median_filter_start * steps
        )


def median_filter(
    distance: Float32[Tensor, "m"],
    hull_distance: Float32[Tensor, "m"],
    neighbors: Int64[Tensor, "m 6"],
) -> Float32[Tensor, "m"]:
    """Nowhere carved more than in the median of the point and the six beside it.

    A slot one point wide has five of the seven and stays.  A hole one point wide is the chance
    of a pixel that no color fits: it is filled.
    """
    carved_depth = (distance - hull_distance).clamp(min=0)
    neighbor_depth = torch.where(
        neighbors >= 0, carved_depth[neighbors.clamp(min=0)], carved_depth[:, None]
    )
    median = torch.cat([carved_depth[:, None], neighbor_depth], dim=1).median(dim=1).values
    return torch.where(median < carved_depth, hull_distance + median, distance)


def grid_neighbors(points: Float32[Tensor, "m 3"], spacing: float) -> Int64[Tensor, "m 6"]:
    """Which points lie one `spacing` before and behind each along the axes; -1: none does."""
    index = ((points - points.amin(0)) / spacing).round().long() + 1
    size = index.amax(0) + 2
    table = torch.full((int(size.prod()),), -1, device=points.device)
    table[_flat_index(index, size)] = torch.arange(len(points), device=points.device)
    axes = torch.eye(3, dtype=torch.int64, device=points.device)
    neighbors = [table[_flat_index(index + sign * axis, size)] for axis in axes for sign in (1, -1)]
    return torch.stack(neighbors, dim=1)


def _flat_index(index: Int64[Tensor, "m 3"], size: Int64[Tensor, "3"]) -> Int64[Tensor, "m"]:
    return (index[:, 0] * size[1] + index[:, 1]) * size[2] + index[:, 2]
