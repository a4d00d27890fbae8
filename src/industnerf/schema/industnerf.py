"""`method.industnerf`, `_plus`, `_depth` and `nerf`: the same settings with other values."""

from dataclasses import dataclass
from typing import Literal

from industnerf.schema.readings import Readings
from industnerf.schema.rules import require

WHERE = "method.industnerf*"


@dataclass(frozen=True)
class LevelSettings:
    """One resolution of the cloud, from coarse to fine."""

    steps: int
    image_px: int
    points: int

    def __post_init__(self) -> None:
        require(self.steps >= 0, f"{WHERE}.levels.steps", self.steps, "at least 0")
        require(self.image_px >= 16, f"{WHERE}.levels.image_px", self.image_px, "at least 16 px")
        require(self.points >= 1000, f"{WHERE}.levels.points", self.points, "at least 1000")


@dataclass(frozen=True)
class WarmUpSettings:
    """Steps on a grid of half the resolution, before the first level."""

    steps: int
    image_px: int

    def __post_init__(self) -> None:
        require(self.steps >= 0, f"{WHERE}.warm_up.steps", self.steps, "at least 0")
        require(self.image_px >= 16, f"{WHERE}.warm_up.image_px", self.image_px, "at least 16 px")


@dataclass(frozen=True)
class NetworkSettings:
    """E and N of section 3.1."""

    use: bool
    features: int
    width: int
    rgb_skip: bool
    channels: int
    magnitude: float
    base: float
    hidden: int
    layers: int
    every: int
    views: int
    rate: float
    straight_rate: float
    encoder_rate: float
    gain: float
    pruned: float

    def __post_init__(self) -> None:
        require(0 <= self.pruned < 1, f"{WHERE}.network.pruned", self.pruned, "in [0, 1)")
        require(self.every >= 1, f"{WHERE}.network.every", self.every, "at least 1")
        require(self.views >= 1, f"{WHERE}.network.views", self.views, "at least 1")
        for name in ("rate", "straight_rate", "encoder_rate", "gain"):
            value = getattr(self, name)
            require(value > 0, f"{WHERE}.network.{name}", value, "above 0")


@dataclass(frozen=True)
class SchoolSettings:
    """What E and N learn from other parts: R14 `shared`."""

    parts: int
    terms: int

    def __post_init__(self) -> None:
        require(self.parts >= 1, f"{WHERE}.school.parts", self.parts, "at least 1")
        require(self.terms >= 1, f"{WHERE}.school.terms", self.terms, "at least 1")


@dataclass(frozen=True)
class ResidualSettings:
    """What is learned for each point by itself: an addition to the paper."""

    use: bool
    density_rate: float
    colour_rate: float


@dataclass(frozen=True)
class SoftnessSettings:
    """Of a surface that is given by distances: R4."""

    first: float
    last: float
    shown: float

    def __post_init__(self) -> None:
        where = f"{WHERE}.softness"
        require(0 < self.last <= self.first, f"{where}.last", self.last, "in (0, softness.first]")
        require(self.shown > 0, f"{where}.shown", self.shown, "above 0")


@dataclass(frozen=True)
class ReliefSettings:
    """A surface carved out of the visual hull: an addition to the paper."""

    use: bool
    rate: float
    wait: int
    slack: float
    fill_every: int
    fill_from: float

    def __post_init__(self) -> None:
        where = f"{WHERE}.relief"
        require(self.rate > 0, f"{where}.rate", self.rate, "above 0")
        require(self.slack >= 1, f"{where}.slack", self.slack, "at least 1")
        require(self.fill_every >= 1, f"{where}.fill_every", self.fill_every, "at least 1")


@dataclass(frozen=True)
class IndustnerfSettings:
    readings: Readings
    grid_res: int
    grid_points: int
    warm_up: WarmUpSettings
    levels: list[LevelSettings]
    refine: Literal["sampled", "divided"]
    carve: bool
    network: NetworkSettings
    school: SchoolSettings
    residual: ResidualSettings
    softness: SoftnessSettings
    relief: ReliefSettings
    initial: float
    ceiling: float
    rays: int
    step: float
    fine_step: float
    surface_px: int
    radius: float
    neighbours: int
    stop: float
    emptiness: float
    veil: float
    depth: float
    noise: float
    least_confidence: float
    spacing: float

    def __post_init__(self) -> None:
        require(
            self.network.use or self.residual.use,
            f"{WHERE}.network.use and residual.use",
            False,
            "true for one of them: else nothing is learned",
        )
        distances = self.readings.activation == "distance"
        free_grid = distances and self.carve and self.residual.use and not self.network.use
        stays_grid = self.refine == "divided" or len(self.levels) == 1
        require(
            not self.relief.use or (free_grid and stays_grid),
            f"{WHERE}.relief.use",
            True,
            "false, or else readings.activation distance, carve and residual.use true, network.use "
            "false and refine divided",
        )
        require(8 <= self.grid_res <= 512, f"{WHERE}.grid_res", self.grid_res, "in 8..512")
        fits = self.grid_points == 0 or (self.grid_points > 0 and self.carve)
        wanted = "0, or at least 1 where carve is true"
        require(fits, f"{WHERE}.grid_points", self.grid_points, wanted)
        require(bool(self.levels), f"{WHERE}.levels", self.levels, "one level or more")
        first = self.levels[0].steps
        require(first >= 1, f"{WHERE}.levels.0.steps", first, "at least 1: else nothing is learned")
        require(self.rays >= 1, f"{WHERE}.rays", self.rays, "at least 1")
        require(0 < self.step <= 4, f"{WHERE}.step", self.step, "in (0, 4] spacings")
        require(0 < self.fine_step <= 4, f"{WHERE}.fine_step", self.fine_step, "in (0, 4] spacings")
        require(self.surface_px >= 16, f"{WHERE}.surface_px", self.surface_px, "at least 16 px")
        require(0 < self.radius <= 8, f"{WHERE}.radius", self.radius, "in (0, 8] spacings")
        require(1 <= self.neighbours <= 64, f"{WHERE}.neighbours", self.neighbours, "in 1..64")
        require(0 <= self.stop < 1, f"{WHERE}.stop", self.stop, "in [0, 1)")
        require(
            distances or self.initial < self.ceiling,
            f"{WHERE}.initial",
            self.initial,
            "below ceiling",
        )
        require(self.depth >= 0, f"{WHERE}.depth", self.depth, "at least 0")
        require(0 <= self.noise < 1, f"{WHERE}.noise", self.noise, "in [0, 1)")
        require(
            0 <= self.least_confidence < 1,
            f"{WHERE}.least_confidence",
            self.least_confidence,
            "in [0, 1)",
        )
        require(0 < self.spacing < 1, f"{WHERE}.spacing", self.spacing, "in (0, 1)")
