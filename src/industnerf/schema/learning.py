"""How nets learn from other parts: `method.<net>.training` and `method.<net>.augment`."""

from dataclasses import dataclass

from industnerf.schema.rules import require


@dataclass(frozen=True)
class TrainingSettings:
    steps: int
    batch: int
    rate: float
    drops: list[float]
    weight_decay: float
    validation: float
    validate_every: int
    patience: int

    def __post_init__(self) -> None:
        at = "method.*.training"
        require(self.steps >= 1, f"{at}.steps", self.steps, "at least 1")
        require(self.batch >= 2, f"{at}.batch", self.batch, "at least 2, for batch norm")
        require(self.rate > 0, f"{at}.rate", self.rate, "more than 0")
        for share in self.drops:
            require(0 < share < 1, f"{at}.drops", share, "a share of the steps in (0, 1)")
        require(self.weight_decay >= 0, f"{at}.weight_decay", self.weight_decay, "at least 0")
        require(0 < self.validation < 1, f"{at}.validation", self.validation, "in (0, 1)")
        require(self.validate_every >= 1, f"{at}.validate_every", self.validate_every, "at least 1")
        require(self.patience >= 1, f"{at}.patience", self.patience, "at least 1")


@dataclass(frozen=True)
class AugmentSettings:
    roll_deg: float
    zoom: float
    colour: float
    noise: float

    def __post_init__(self) -> None:
        at = "method.*.augment"
        require(0 <= self.roll_deg <= 180, f"{at}.roll_deg", self.roll_deg, "in [0, 180]")
        require(0 <= self.zoom < 1, f"{at}.zoom", self.zoom, "in [0, 1)")
        require(0 <= self.colour < 1, f"{at}.colour", self.colour, "in [0, 1)")
        require(0 <= self.noise < 1, f"{at}.noise", self.noise, "in [0, 1)")
