"""What networks learn from: a part of the study, or a procedural solid; both offer the same."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float, Float16, Float32, UInt8

from industnerf.artifacts.state import ModelState
from industnerf.learning.targets import OccupancyPool


@runtime_checkable
class TrainingShape(Protocol):
    """Views of a shape and targets in its unit cube; read or made when they are asked for.

    Views are in nested order (`geometry.cameras.nested_view_order`): the first few of them look
    from all round, and `count` is how many are wanted at most.  Targets that are drawn at random
    depend on `rng`.
    """

    @property
    def part_id(self) -> str: ...

    @property
    def group(self) -> str: ...  # shapes of one group are validated on together

    def rgb(self, px: int, count: int) -> UInt8[np.ndarray, "views {px} {px} 3"]: ...

    def background(self, count: int) -> Float[np.ndarray, "views 3"]: ...

    def picture_frames(self, count: int) -> Float[np.ndarray, "views 3 3"]: ...

    def filled_shares(self) -> UInt8[np.ndarray, "n n n"]: ...

    def occupancy_pool(self, count: int, rng: np.random.Generator) -> OccupancyPool: ...

    def surface_pool(
        self, rng: np.random.Generator
    ) -> Float32[np.ndarray, "pool 3"] | Float16[np.ndarray, "pool 3"]: ...


@dataclass(frozen=True)
class Prior:
    """What a network brings along when it begins to learn from parts."""

    solids: Sequence[TrainingShape] = ()  # procedural ones, which make up half of its batches
    weights: ModelState | None = None  # from an earlier training; None: they start at random


NO_PRIOR = Prior()
