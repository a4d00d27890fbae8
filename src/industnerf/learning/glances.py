"""What nets of one view are shown: one photograph of each part, another one every time."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
import torch
from jaxtyping import Float, Int, UInt8
from torch import Tensor, nn

from industnerf.geometry.cameras import Cameras
from industnerf.learning.augment import as_tensor, augmented
from industnerf.learning.frames import rolled, turns_of
from industnerf.schema import AtlasNetSettings, AugmentSettings, OccupancySettings
from industnerf.schema.learning import Frame

Batch = Int[np.ndarray, "b"]


@runtime_checkable
class Photographed(Protocol):
    """A part to learn from, as `industnerf.methods.base.Example` is."""

    def rgb(self, px: int, count: int) -> UInt8[np.ndarray, "views {px} {px} 3"]: ...

    def cameras(self, count: int) -> Cameras: ...


@dataclass(frozen=True)
class Glances:
    """Views of every part, in memory, and how each is turned."""

    images: list[UInt8[np.ndarray, "_ px px 3"]]
    turns: list[Float[np.ndarray, "_ 3 3"]]  # from the part's axes to those of the answer
    augment: AugmentSettings
    frame: Frame

    @staticmethod
    def of(
        examples: Sequence[Photographed], settings: AtlasNetSettings | OccupancySettings
    ) -> "Glances":
        """Read the photographs."""
        return Glances(
            [one.rgb(settings.image_px, settings.views) for one in examples],
            [turns_of(one.cameras(settings.views), settings.frame) for one in examples],
            settings.augment,
            settings.frame,
        )

    def drawn(self, which: Batch, rng: np.random.Generator) -> list[int]:
        """A view of each of the parts `which`, at random."""
        return [int(rng.integers(len(self.images[part]))) for part in which]

    def axes(self, which: Batch, views: list[int]) -> Float[np.ndarray, "b 3 3"]:
        """Of points p of the parts, p @ turn are in the axes that the net answers in."""
        return np.stack([self.turns[part][view] for part, view in zip(which, views, strict=True)])

    def shown(
        self, net: nn.Module, which: Batch, rng: np.random.Generator
    ) -> tuple[Float[Tensor, "b 3 px px"], Float[np.ndarray, "b 3 3"]]:
        """A picture of each part, on the device of `net`, and its axes.

        Pictures vary only while `net` learns.
        """
        views = self.drawn(which, rng)
        images = np.stack([self.images[p][v] for p, v in zip(which, views, strict=True)])
        seen, turns = as_tensor(images, _device(net)), self.axes(which, views)
        if net.training:
            seen, rolls = augmented(seen, self.augment, rng)
            turns = rolled(turns, rolls, self.frame)
        return seen, turns


def _device(net: nn.Module) -> torch.device:
    return next(net.parameters()).device
