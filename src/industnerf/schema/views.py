"""`views`: cameras, light and images."""

from dataclasses import dataclass
from typing import Annotated, Literal

from industnerf.schema.validators import (
    Fraction,
    NonNegativeFloat,
    NonNegativeInt,
    PositiveInt,
    Rule,
    at_least,
    in_interval,
    non_empty,
    require,
)

COLOR = Rule(lambda rgb: len(rgb) == 3 and all(0 <= c <= 1 for c in rgb), "three numbers in [0, 1]")
DIRECTION = Rule(lambda xyz: len(xyz) == 3 and any(xyz), "three numbers, not all 0")
HalfFraction = Annotated[float, in_interval("[0, 0.5]")]
HalfTurnDeg = Annotated[float, in_interval("[0, 180]")]


@dataclass(frozen=True)
class LightParams:
    ambient: NonNegativeFloat
    directions: list[Annotated[list[float], DIRECTION]]
    intensities: list[float]
    rotation_jitter_deg: Annotated[float, in_interval("[0, 90]")]
    intensity_jitter: Fraction

    def __post_init__(self) -> None:
        num_lights, intensities = len(self.directions), self.intensities
        is_complete = len(intensities) == num_lights
        require(
            is_complete,
            "intensities",
            intensities,
            f"one number for each of the {num_lights} directions",
        )


@dataclass(frozen=True)
class PhotorealisticParams:
    """Read with `views.shading: photorealistic` alone."""

    light_half_angle_deg: Annotated[float, in_interval("[0, 90)")]
    shadow_samples: PositiveInt


@dataclass(frozen=True)
class JitterParams:
    """How the cameras really stand; recorded truly."""

    distance: HalfFraction
    look_at: HalfFraction
    roll_deg: HalfTurnDeg
    focal: HalfFraction


@dataclass(frozen=True)
class CalibrationParams:
    """How wrong the recorded training cameras are; the images do not change."""

    rotation_deg: HalfTurnDeg
    position: HalfFraction
    focal: HalfFraction


@dataclass(frozen=True)
class SensorParams:
    """What the camera makes of the light."""

    blur_px: Annotated[float, in_interval("[0, 32]")]
    noise: Annotated[float, in_interval("[0, 1]")]
    jpeg_quality: Annotated[int, in_interval("[0, 95]", "; 0 is off")]


@dataclass(frozen=True)
class ViewsParams:
    count: PositiveInt
    held_out: NonNegativeInt
    resolution: Annotated[int, at_least(8, " px")]
    fov_deg: Annotated[float, in_interval("(0, 120)")]
    radius: float
    rig: Literal["sphere", "turntable", "hemisphere"]
    elevations_deg: Annotated[list[Annotated[float, in_interval("(-90, 90)")]], non_empty("angle")]
    background: Literal["contrast", "white", "gray", "black", "random"]
    albedo: Annotated[list[float], COLOR]
    shading: Literal["matte", "photorealistic"]
    light: LightParams
    photorealistic: PhotorealisticParams
    crease_deg: Annotated[float, in_interval("[0, 180]")]
    edge_samples: PositiveInt
    jitter: JitterParams
    calibration: CalibrationParams
    sensor: SensorParams
