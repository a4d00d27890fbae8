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

from industnerf.schema import ReliefSettings

MARGIN = 2.0  # of the level's own, beyond the hull: points needed there to say where it ends
FARTHEST = 9.0  # distances are kept within this: nothing is learned from larger ones


class Relief:
    """The constraints that distances on a grid learn under."""

    def __init__(
        self,
        hull: Float32[Tensor, "m"],
        beside: Int64[Tensor, "m 6"],
        settings: ReliefSettings,
        start: Float32[Tensor, "m"] | None = None,
        believed: bool = True,
    ) -> None:
        self.hull, self._beside, self._ways = hull, beside, settings
        self._back = settings.back if believed else settings.back_in_doubt
        start = hull if start is None else start.clamp(-settings.start.deepest, FARTHEST)
        self._start = torch.maximum(start, hull)
        self._shallow = hull >= -settings.back_within
        self._least = torch.where(hull > 0, hull, hull * settings.slack)

    def rate(self, beta: float) -> float:
        """Of Adam: a soft surface may move far."""
        return self._ways.rate * beta

    def within(self, distance: Float32[Tensor, "m"] | None) -> Float32[Tensor, "m"]:
        """To start from: the start's distances, or `distance` and nowhere deeper than the hull."""
        return self._start if distance is None else torch.maximum(distance, self.hull)

    @torch.no_grad()
    def fall_back(self, distance: Float32[Tensor, "m"], rate: float) -> None:
        """Of what was carved near the hull a little is undone: a share of a step at `rate`."""
        back = torch.maximum(distance - self._back * rate, self._start)
        falls = (distance > self._start) & self._shallow
        distance.copy_(torch.where(falls, back, distance))

    @torch.no_grad()
    def settle(self, distance: Float32[Tensor, "m"], taken: int, steps: int) -> None:
        """Back inside the hull; now and then, and at the end, without pits."""
        distance.copy_(torch.maximum(distance, self._least)).clamp_(-FARTHEST, FARTHEST)
        if self._is_due(taken, steps):
            distance.copy_(without_pits(distance, self.hull, self._beside))

    def _is_due(self, taken: int, steps: int) -> bool:
        """Whether pits are filled after so many of the `steps`."""
        every = self._ways.fill_every
        if not every:
            return False
        return taken == steps or (taken % every == 0 and taken >= self._ways.fill_from * steps)


def without_pits(
    distance: Float32[Tensor, "m"], hull: Float32[Tensor, "m"], beside: Int64[Tensor, "m 6"]
) -> Float32[Tensor, "m"]:
    """Nowhere carved more than in the median of the point and the six beside it.

    A slot one point wide has five of the seven and stays.  A hole one point wide is the chance
    of a pixel that no colour fits: it is filled.
    """
    carved = (distance - hull).clamp(min=0)
    around = torch.where(beside >= 0, carved[beside.clamp(min=0)], carved[:, None])
    median = torch.cat([carved[:, None], around], dim=1).median(dim=1).values
    return torch.where(median < carved, hull + median, distance)


def beside_on_grid(points: Float32[Tensor, "m 3"], spacing: float) -> Int64[Tensor, "m 6"]:
    """Which points lie one `spacing` before and behind each along the axes; -1: none does."""
    index = ((points - points.amin(0)) / spacing).round().long() + 1
    size = index.amax(0) + 2
    table = torch.full((int(size.prod()),), -1, device=points.device)
    table[_flat(index, size)] = torch.arange(len(points), device=points.device)
    steps = torch.eye(3, dtype=torch.int64, device=points.device)
    moved = [table[_flat(index + way * step, size)] for step in steps for way in (1, -1)]
    return torch.stack(moved, dim=1)


def _flat(index: Int64[Tensor, "m 3"], size: Int64[Tensor, "3"]) -> Int64[Tensor, "m"]:
    return (index[:, 0] * size[1] + index[:, 1]) * size[2] + index[:, 2]
