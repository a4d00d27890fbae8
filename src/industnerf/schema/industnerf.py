"""`method.industnerf`, `_plus`, `_depth`, `_shared` and `nerf`: the same keys, other values."""

from dataclasses import dataclass
from typing import Annotated, Literal

from industnerf.schema.carving import SpaceCarvingSettings
from industnerf.schema.readings import Readings
from industnerf.schema.rules import (
    Count,
    CountOr0,
    GridRes,
    ImagePx,
    Positive,
    PositiveOr0,
    Rule,
    Share,
    at_least,
    one_or_more,
    require,
    within,
)

SIXES = Rule(lambda count: count > 0 and count % 6 == 0, "a multiple of 6: sine, cosine, 3 axes")
Spacings = Annotated[float, within("(0, 4]", " spacings")]


@dataclass(frozen=True)
class LevelSettings:
    """One resolution of the cloud, from coarse to fine."""

    steps: CountOr0
    image_px: ImagePx
    points: Annotated[int, at_least(1000)]


@dataclass(frozen=True)
class WarmUpSettings:
    """Steps on a grid of half the resolution, before the first level."""

    steps: CountOr0
    image_px: ImagePx


@dataclass(frozen=True)
class NetworkSettings:
    """E and N of section 3.1."""

    use: bool
    features: Count
    width: Count
    rgb_skip: bool
    channels: Annotated[int, SIXES]
    magnitude: Positive
    base: Positive
    hidden: Count
    layers: Count
    every: Count
    views: Count
    rate: Positive
    straight_rate: Positive
    encoder_rate: Positive
    gain: Positive
    pruned: Share


@dataclass(frozen=True)
class SchoolSettings:
    """What E and N learn from other parts: R14 `shared`."""

    parts: Count
    terms: Count


@dataclass(frozen=True)
class ResidualSettings:
    """What is learned for each point by itself: an addition to the paper."""

    use: bool
    density_rate: PositiveOr0
    colour_rate: PositiveOr0


@dataclass(frozen=True)
class SoftnessSettings:
    """Of a surface that is given by distances: R4."""

    first: Positive
    last: Positive
    shown: Positive

    def __post_init__(self) -> None:
        require(self.last <= self.first, "last", self.last, f"at most first, {self.first:g}")


@dataclass(frozen=True)
class StartSettings(SpaceCarvingSettings):
    """Of a relief that starts at the photo hull."""

    use: bool
    deepest: Positive


@dataclass(frozen=True)
class ReliefSettings:
    """A surface carved out of the visual hull: an addition to the paper."""

    use: bool
    start: StartSettings
    rate: Positive
    back: Share
    back_in_doubt: Share
    back_within: PositiveOr0
    slack: Annotated[float, at_least(1)]
    fill_every: CountOr0
    fill_from: Annotated[float, within("[0, 1]")]

    def __post_init__(self) -> None:
        require(self.use or not self.start.use, "start.use", True, "false where use is false")


@dataclass(frozen=True)
class RecolourSettings:
    """Colours alone, once the surface is found: an addition to the paper."""

    steps: CountOr0
    rate: Positive


@dataclass(frozen=True)
class FusionSettings:
    """Of the depths that all views see: reading `fused` of R11."""

    grid_res: GridRes
    truncation: Annotated[float, at_least(1, " cell")]
    points: Count


@dataclass(frozen=True)
class IndustnerfSettings:
    readings: Readings
    grid_res: GridRes
    grid_points: CountOr0
    warm_up: WarmUpSettings
    levels: Annotated[list[LevelSettings], one_or_more("level")]
    refine: Literal["sampled", "divided"]
    carve: bool
    tolerance: Share
    network: NetworkSettings
    school: SchoolSettings
    residual: ResidualSettings
    softness: SoftnessSettings
    relief: ReliefSettings
    recolour: RecolourSettings
    initial: float
    ceiling: float
    rays: Count
    step: Spacings
    fine_step: Spacings
    surface_px: ImagePx
    radius: Annotated[float, within("(0, 8]", " spacings")]
    neighbours: Annotated[int, within("[1, 64]")]
    stop: Share
    emptiness: PositiveOr0
    veil: PositiveOr0
    depth: PositiveOr0
    noise: Share
    least_confidence: Share
    fusion: FusionSettings
    spacing: Annotated[float, within("(0, 1)")]

    def __post_init__(self) -> None:
        learns = self.network.use or self.residual.use
        require(learns, "network.use", False, "true, or residual.use: else nothing is learned")
        steps = self.levels[0].steps
        require(steps >= 1, "levels[0].steps", steps, "at least 1: else nothing is learned")
        halved = not self.warm_up.steps or self.grid_res % 2 == 0
        require(halved, "grid_res", self.grid_res, "even: the warm-up has half of it")
        cut = self.grid_points == 0 or self.carve
        require(cut, "grid_points", self.grid_points, "0 where carve is false")
        fits = not self.relief.use or self._has_grid_of_distances()
        wanted = "readings.activation distance, carve and residual.use true, network.use false"
        require(fits, "relief.use", True, f"false without {wanted}, refine divided")
        alone = not self.recolour.steps or self._points_alone()
        wanted = "0 without residual.use true and network.use false"
        require(alone, "recolour.steps", self.recolour.steps, wanted)
        bounded = self.readings.activation == "distance" or self.initial < self.ceiling
        require(bounded, "initial", self.initial, "below ceiling")

    def _points_alone(self) -> bool:
        """Whether the field is what each point learns by itself."""
        return self.residual.use and not self.network.use

    def _has_grid_of_distances(self) -> bool:
        """Whether each point has a distance of its own, and stays in its place in a grid."""
        stays = self.refine == "divided" or len(self.levels) == 1
        return (
            self.readings.activation == "distance" and self.carve and self._points_alone() and stays
        )
