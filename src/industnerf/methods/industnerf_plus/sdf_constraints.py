"""Signed distances inside the visual hull: the points hold distances instead of densities.

Every point starts at its signed distance from the visual hull, or from the photo hull, so the
first surface is that of the hull.  It is soft at first: light reaches far inside.  While it
hardens, training carves what the images contradict.  Deep inside the photo hull all points start
at the same depth (`initial_max_depth`): from its true depth a point could not be carved in time.

    carved depth = max(0, distance - distance from the hull)

A point may lie `max_depth_factor` times as deep inside as it does in the hull.

Of a plain face most images contradict neither the face nor a shallow hollow in it.  So what
training does not keep carving relaxes to where it started; faster if the photo hull is not
reliable.  What is carved deeper inside the visual hull than `relax_max_depth` stays: it is a
pocket.

After VolSDF -- Yariv et al. (2021).  Lengths are in spacings of the first level.
"""

import torch
from jaxtyping import Float32, Int64
from torch import Tensor

from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.optimizer import Constraints
from industnerf.schema import SdfSettings

HULL_MARGIN = 2.0  # spacings of the level: points beyond the hull that show where it ends
VISIBILITY_MARGIN = 1.0  # pixels farther outside the hull than this tell nothing new
MAX_ABS_SDF = 9.0  # distances are clamped to this


class SdfConstraints(Constraints):
    """The constraints of signed distances at the points of a grid."""

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
        """Learning rate of the distances: a soft surface may move far."""
        return self._settings.lr * beta

    def visible_points(
        self, points: Float32[Tensor, "m 3"], order: Int64[Tensor, "m"]
    ) -> Float32[Tensor, "v 3"]:
        """Those near the hull or inside."""
        is_visible = torch.empty_like(self._is_shallow)
        is_visible[order] = self.hull_distance < VISIBILITY_MARGIN
        return points[is_visible]

    def initial_raw(self, raw: Float32[Tensor, "m"] | None) -> Float32[Tensor, "m"]:
        """The initial distances, or those of the last level, cut by the hull."""
        return self._initial_distance if raw is None else torch.maximum(raw, self.hull_distance)

    def project(self, field: Field, beta: float, steps_done: int, num_steps: int) -> None:
        """Relax, clamp and filter the distances after a step."""
        self.relax_to_initial(field.raw, self.lr(beta))
        self.constrain(field.raw, steps_done, num_steps)

    @torch.no_grad()
    def relax_to_initial(self, distance: Float32[Tensor, "m"], lr: float) -> None:
        """Undo a little of what was carved near the hull: a share `relax_rate` of a step."""
        relaxed = torch.maximum(distance - self._relax_rate * lr, self._initial_distance)
        is_relaxed = (distance > self._initial_distance) & self._is_shallow
        distance.copy_(torch.where(is_relaxed, relaxed, distance))

    @torch.no_grad()
    def constrain(self, distance: Float32[Tensor, "m"], steps_done: int, steps: int) -> None:
        """Clamp the distances to the hull; at some steps, and at the last, filter out pits."""
        distance.copy_(torch.maximum(distance, self._min_distance)).clamp_(
            -MAX_ABS_SDF, MAX_ABS_SDF
        )
        if self._is_filter_step(steps_done, steps):
            distance.copy_(median_filter(distance, self.hull_distance, self._neighbors))

    def _is_filter_step(self, steps_done: int, steps: int) -> bool:
        """Whether the median filter runs after so many of the `steps`."""
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
    """Limit the carved depth to the median of the point and its six neighbors.

    A slot one point wide is carved at five of the seven and stays.  A hole one point wide is
    filled: it comes from single pixels that no color fits.
    """
    carved_depth = (distance - hull_distance).clamp(min=0)
    neighbor_depth = torch.where(
        neighbors >= 0, carved_depth[neighbors.clamp(min=0)], carved_depth[:, None]
    )
    median = torch.cat([carved_depth[:, None], neighbor_depth], dim=1).median(dim=1).values
    return torch.where(median < carved_depth, hull_distance + median, distance)


def grid_neighbors(points: Float32[Tensor, "m 3"], spacing: float) -> Int64[Tensor, "m 6"]:
    """Indices of the points one `spacing` from each, in both directions of the axes; -1: none."""
    index = ((points - points.amin(0)) / spacing).round().long() + 1
    size = index.amax(0) + 2
    table = torch.full((int(size.prod()),), -1, device=points.device)
    table[_flat_index(index, size)] = torch.arange(len(points), device=points.device)
    axes = torch.eye(3, dtype=torch.int64, device=points.device)
    neighbors = [table[_flat_index(index + sign * axis, size)] for axis in axes for sign in (1, -1)]
    return torch.stack(neighbors, dim=1)


def _flat_index(index: Int64[Tensor, "m 3"], size: Int64[Tensor, "3"]) -> Int64[Tensor, "m"]:
    return (index[:, 0] * size[1] + index[:, 1]) * size[2] + index[:, 2]
