"""How nets learn from other parts: `method.<net>.training` and `method.<net>.augment`."""

from dataclasses import dataclass
from typing import Annotated, Literal

from industnerf.schema.rules import (
    Count,
    InnerShare,
    Positive,
    PositiveOr0,
    Share,
    at_least,
    within,
)

Frame = Literal["part", "view"]  # the axes that a net of one view answers in


@dataclass(frozen=True)
class TrainingSettings:
    steps: Count
    batch: Annotated[int, at_least(2, ", for batch norm")]
    rate: Positive
    drops: list[InnerShare]
    weight_decay: PositiveOr0
    validation: InnerShare
    validate_every: Count
    patience: Count


@dataclass(frozen=True)
class AugmentSettings:
    roll_deg: Annotated[float, within("[0, 180]")]
    zoom: Share
    colour: Share
    noise: Share
