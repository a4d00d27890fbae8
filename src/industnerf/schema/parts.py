"""`parts`: where parts come from, and how the user's own files are cleaned."""

from dataclasses import dataclass
from typing import Literal

from industnerf.schema.rules import require

Units = Literal["mm", "cm", "m", "inch"]


@dataclass(frozen=True)
class CleanParams:
    weld: float
    speck_area: float
    speck_size: float
    specks_at_most: float
    orient: bool
    union: bool
    fill_holes: bool
    smooth_steps: int

    def __post_init__(self) -> None:
        require(0 <= self.weld < 1e-2, "parts.clean.weld", self.weld, "a share < 0.01")
        for key in ("speck_area", "speck_size", "specks_at_most"):
            value = getattr(self, key)
            require(0 <= value < 0.5, f"parts.clean.{key}", value, "a share in [0, 0.5)")
        steps = self.smooth_steps
        require(steps >= 0, "parts.clean.smooth_steps", steps, "at least 0")


@dataclass(frozen=True)
class PartsParams:
    source: Literal["embedded", "path"]
    path: str
    pattern: str
    units: Units
    select: list[str]
    split_bodies: bool
    time_limit_s: float
    memory_limit_mb: int
    clean: CleanParams

    def __post_init__(self) -> None:
        require(self.time_limit_s > 0, "parts.time_limit_s", self.time_limit_s, "more than 0")
        least = 1024
        limit = self.memory_limit_mb
        require(limit >= least, "parts.memory_limit_mb", limit, f"at least {least}")
