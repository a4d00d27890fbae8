"""`views`: cameras, light and pictures."""

from dataclasses import dataclass
from typing import Annotated, Literal

from industnerf.schema.rules import (
    Count,
    CountOr0,
    PositiveOr0,
    Rule,
    Share,
    at_least,
    one_or_more,
    require,
    within,
)

COLOUR = Rule(
    lambda rgb: len(rgb) == 3 and all(0 <= c <= 1 for c in rgb), "three numbers in [0, 1]"
)
DIRECTION = Rule(lambda xyz: len(xyz) == 3 and any(xyz), "three numbers, not all 0")
Spread = Annotated[float, within("[0, 0.5]")]
SpreadDeg = Annotated[float, within("[0, 180]")]


@dataclass(frozen=True)
class LightParams:
    ambient: PositiveOr0
    directions: list[Annotated[list[float], DIRECTION]]
    intensities: list[float]
    sway_deg: Annotated[float, within("[0, 90]")]
    flicker: Share

    def __post_init__(self) -> None:
        lamps, given = len(self.directions), self.intensities
        fits = len(given) == lamps
        require(fits, "intensities", given, f"one number for each of the {lamps} directions")


@dataclass(frozen=True)
class PhotoParams:
    """Read with `views.shading: photo` alone."""

    lamp_deg: Annotated[float, within("[0, 90)")]
    shadow_samples: Count


@dataclass(frozen=True)
class JitterParams:
    """How the cameras really stand; recorded truly."""

    distance: Spread
    aim: Spread
    roll_deg: SpreadDeg
    focal: Spread


@dataclass(frozen=True)
class CalibrationParams:
    """How wrong the recorded training cameras are; the pictures do not change."""

    rotation_deg: SpreadDeg
    position: Spread
    focal: Spread


@dataclass(frozen=True)
class SensorParams:
    """What the camera makes of the light."""

    blur_px: Annotated[float, within("[0, 32]")]
    noise: Annotated[float, within("[0, 1]")]
    jpeg_quality: Annotated[int, within("[0, 95]", "; 0 is off")]


@dataclass(frozen=True)
class ViewsParams:
    count: Count
    held_out: CountOr0
    resolution: Annotated[int, at_least(8, " px")]
    fov_deg: Annotated[float, within("(0, 120)")]
    radius: float
    rig: Literal["sphere", "rings", "hemisphere"]
    elevations_deg: Annotated[list[Annotated[float, within("(-90, 90)")]], one_or_more("angle")]
    background: Literal["white", "grey", "black", "random"]
    albedo: Annotated[list[float], COLOUR]
    shading: Literal["matte", "photo"]
    light: LightParams
    photo: PhotoParams
    crease_deg: Annotated[float, within("[0, 180]")]
    edge_samples: Count
    jitter: JitterParams
    calibration: CalibrationParams
    sensor: SensorParams
