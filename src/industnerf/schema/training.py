"""How nets learn from other parts: `method.<net>.training` and `method.<net>.augment`."""

from dataclasses import dataclass
from typing import Annotated, Literal

from industnerf.schema.validators import (
    Fraction,
    NonNegativeFloat,
    NonNegativeInt,
    OpenFraction,
    PositiveFloat,
    PositiveInt,
    at_least,
    in_interval,
)

# the axes that a network of one view knows points in
OutputAxes = Literal["part", "picture"]
QueryAxes = Literal["part", "picture", "both"]
KeptWeights = Literal["best", "last"]  # of a training: of its validations, or of its steps


@dataclass(frozen=True)
class TrainingSettings:
    max_steps: NonNegativeInt  # 0: the weights stay as they were
    batch_size: Annotated[int, at_least(2, ", for batch norm")]
    lr: PositiveFloat
    weight_decay: NonNegativeFloat
    val_fraction: OpenFraction
    val_interval: PositiveInt
    patience: PositiveInt
    keep: KeptWeights


@dataclass(frozen=True)
class AugmentSettings:
    roll_deg: Annotated[float, in_interval("[0, 180]")]
    zoom: Fraction
    color_jitter: Fraction
    noise: Fraction
