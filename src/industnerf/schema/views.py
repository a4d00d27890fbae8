"""`views`: cameras, light and pictures."""

from dataclasses import dataclass
from typing import Literal

from industnerf.schema.rules import require


@dataclass(frozen=True)
class LightParams:
    ambient: float
    directions: list[list[float]]
    intensities: list[float]
    sway_deg: float
    flicker: float

    def __post_init__(self) -> None:
        require(self.ambient >= 0, "views.light.ambient", self.ambient, "at least 0")
        require(
            len(self.directions) == len(self.intensities),
            "views.light.intensities",
            self.intensities,
            f"one number for each of the {len(self.directions)} directions",
        )
        require(0 <= self.sway_deg <= 90, "views.light.sway_deg", self.sway_deg, "in [0, 90]")
        require(0 <= self.flicker < 1, "views.light.flicker", self.flicker, "in [0, 1)")
        for direction in self.directions:
            require(
                len(direction) == 3 and any(direction),
                "views.light.directions",
                direction,
                "three numbers, not all 0",
            )


@dataclass(frozen=True)
class PhotoParams:
    """Read with `views.shading: photo` alone."""

    lamp_deg: float
    shadow_samples: int

    def __post_init__(self) -> None:
        require(0 <= self.lamp_deg < 90, "views.photo.lamp_deg", self.lamp_deg, "in [0, 90)")
        samples = self.shadow_samples
        require(samples >= 1, "views.photo.shadow_samples", samples, "at least 1")


@dataclass(frozen=True)
class JitterParams:
    """How the cameras really stand; recorded truly."""

    distance: float
    aim: float
    roll_deg: float
    focal: float

    def __post_init__(self) -> None:
        _require_spreads("views.jitter", vars(self))


@dataclass(frozen=True)
class CalibrationParams:
    """How wrong the recorded training cameras are; the pictures do not change."""

    rotation_deg: float
    position: float
    focal: float

    def __post_init__(self) -> None:
        _require_spreads("views.calibration", vars(self))


@dataclass(frozen=True)
class SensorParams:
    """What the camera makes of the light."""

    blur_px: float
    noise: float
    jpeg_quality: int

    def __post_init__(self) -> None:
        require(0 <= self.blur_px <= 32, "views.sensor.blur_px", self.blur_px, "in [0, 32]")
        require(0 <= self.noise <= 1, "views.sensor.noise", self.noise, "in [0, 1]")
        quality = self.jpeg_quality
        require(0 <= quality <= 95, "views.sensor.jpeg_quality", quality, "in [0, 95]; 0 is off")


@dataclass(frozen=True)
class ViewsParams:
    count: int
    held_out: int
    resolution: int
    fov_deg: float
    radius: float
    rig: Literal["sphere", "rings", "hemisphere"]
    elevations_deg: list[float]
    background: Literal["white", "grey", "black", "random"]
    albedo: list[float]
    shading: Literal["matte", "photo"]
    light: LightParams
    photo: PhotoParams
    crease_deg: float
    edge_samples: int
    jitter: JitterParams
    calibration: CalibrationParams
    sensor: SensorParams

    def __post_init__(self) -> None:
        require(self.count >= 1, "views.count", self.count, "at least 1")
        require(self.held_out >= 0, "views.held_out", self.held_out, "at least 0")
        require(self.resolution >= 8, "views.resolution", self.resolution, "at least 8 px")
        require(0 < self.fov_deg < 120, "views.fov_deg", self.fov_deg, "between 0 and 120")
        require(self.edge_samples >= 1, "views.edge_samples", self.edge_samples, "at least 1")
        require(0 <= self.crease_deg <= 180, "views.crease_deg", self.crease_deg, "in [0, 180]")
        require(
            len(self.albedo) == 3 and all(0 <= c <= 1 for c in self.albedo),
            "views.albedo",
            self.albedo,
            "three numbers in [0, 1]",
        )
        require(
            len(self.elevations_deg) > 0 and all(abs(e) < 90 for e in self.elevations_deg),
            "views.elevations_deg",
            self.elevations_deg,
            "at least one angle between -90 and 90",
        )


def _require_spreads(section: str, spreads: dict[str, float]) -> None:
    for key, spread in spreads.items():
        most = 180 if key.endswith("_deg") else 0.5
        require(0 <= spread <= most, f"{section}.{key}", spread, f"in [0, {most}]")
