"""`parts`: where parts come from, and how the user's own files are cleaned."""

from dataclasses import dataclass
from typing import Annotated, Literal

from industnerf.schema.validators import NonNegativeInt, PositiveFloat, Rule, at_least, in_interval

Units = Literal["mm", "cm", "m", "inch"]
SHELL_SAFE_PATH = Rule(
    lambda path: "'" not in path, "a path without an apostrophe, in which DVC hands it to a shell"
)
SmallFraction = Annotated[float, in_interval("[0, 0.5)")]


@dataclass(frozen=True)
class RepairParams:
    weld: Annotated[float, in_interval("[0, 0.01)")]
    small_component_area: SmallFraction
    small_component_size: SmallFraction
    max_removed_area: SmallFraction
    fix_winding: bool
    boolean_union: bool
    fill_holes: bool
    smooth_steps: NonNegativeInt


@dataclass(frozen=True)
class PartsParams:
    source: Literal["embedded", "path"]
    path: Annotated[str, SHELL_SAFE_PATH]
    pattern: str
    units: Units
    override_units: bool
    select: list[str]
    split_bodies: bool
    time_limit_s: PositiveFloat
    memory_limit_mb: Annotated[int, at_least(1024)]
    repair: RepairParams
