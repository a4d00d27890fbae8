"""`parts`: where parts come from, and how the user's own files are cleaned."""

from dataclasses import dataclass
from typing import Annotated, Literal

from industnerf.schema.rules import CountOr0, Positive, Rule, at_least, within

Units = Literal["mm", "cm", "m", "inch"]
QUOTABLE = Rule(
    lambda path: "'" not in path, "a path without an apostrophe, in which DVC hands it to a shell"
)
SmallShare = Annotated[float, within("[0, 0.5)")]


@dataclass(frozen=True)
class CleanParams:
    weld: Annotated[float, within("[0, 0.01)")]
    speck_area: SmallShare
    speck_size: SmallShare
    specks_at_most: SmallShare
    orient: bool
    union: bool
    fill_holes: bool
    smooth_steps: CountOr0


@dataclass(frozen=True)
class PartsParams:
    source: Literal["embedded", "path"]
    path: Annotated[str, QUOTABLE]
    pattern: str
    units: Units
    select: list[str]
    split_bodies: bool
    time_limit_s: Positive
    memory_limit_mb: Annotated[int, at_least(1024)]
    clean: CleanParams
