"""The type and range of every key of params.yaml, and no value: one screen, one knob a line."""

from dataclasses import dataclass
from typing import Literal

from industnerf.errors import BadParams


def require(holds: bool, key: str, value: object, rule: str) -> None:
    """Raise BadParams unless `holds`."""
    if not holds:
        raise BadParams(f"params.yaml: {key} is {value!r}, must be {rule}")


@dataclass(frozen=True)
class PartsParams:
    source: Literal["embedded", "path"]
    path: str
    pattern: str
    units: Literal["mm", "cm", "m", "inch"]
    select: list[str]
    weld: float
    eyes: int

    def __post_init__(self) -> None:
        require(0 <= self.weld < 1e-2, "parts.weld", self.weld, "a share of the diagonal < 0.01")
        require(self.eyes >= 1, "parts.eyes", self.eyes, "at least 1")


@dataclass(frozen=True)
class LightParams:
    ambient: float
    directions: list[list[float]]
    intensities: list[float]

    def __post_init__(self) -> None:
        require(self.ambient >= 0, "views.light.ambient", self.ambient, "at least 0")
        require(
            len(self.directions) == len(self.intensities),
            "views.light.intensities",
            self.intensities,
            f"one number for each of the {len(self.directions)} directions",
        )
        for direction in self.directions:
            require(
                len(direction) == 3 and any(direction),
                "views.light.directions",
                direction,
                "three numbers, not all 0",
            )


@dataclass(frozen=True)
class ViewsParams:
    count: int
    held_out: int
    resolution: int
    fov_deg: float
    radius: float
    background: list[float]
    albedo: list[float]
    light: LightParams
    crease_deg: float
    edge_samples: int

    def __post_init__(self) -> None:
        require(self.count >= 1, "views.count", self.count, "at least 1")
        require(self.held_out >= 0, "views.held_out", self.held_out, "at least 0")
        require(self.resolution >= 8, "views.resolution", self.resolution, "at least 8 px")
        require(0 < self.fov_deg < 120, "views.fov_deg", self.fov_deg, "between 0 and 120")
        require(self.edge_samples >= 1, "views.edge_samples", self.edge_samples, "at least 1")
        require(0 <= self.crease_deg <= 180, "views.crease_deg", self.crease_deg, "in [0, 180]")
        for key, colour in (("background", self.background), ("albedo", self.albedo)):
            require(
                len(colour) == 3 and all(0 <= c <= 1 for c in colour),
                f"views.{key}",
                colour,
                "three numbers in [0, 1]",
            )


@dataclass(frozen=True)
class SplitParams:
    dev_share: float
    folds: int

    def __post_init__(self) -> None:
        require(0 <= self.dev_share < 1, "split.dev_share", self.dev_share, "in [0, 1)")
        require(self.folds >= 2, "split.folds", self.folds, "at least 2")


@dataclass(frozen=True)
class HullSettings:
    cell_px: float
    points: int

    def __post_init__(self) -> None:
        require(0 < self.cell_px <= 8, "method.hull.cell_px", self.cell_px, "in (0, 8] px")
        require(self.points >= 1, "method.hull.points", self.points, "at least 1")


@dataclass(frozen=True)
class HullRgbSettings:
    hull: HullSettings
    tolerance: float

    def __post_init__(self) -> None:
        require(0 <= self.tolerance < 1, "method.hull_rgb.tolerance", self.tolerance, "in [0, 1)")


@dataclass(frozen=True)
class SampleSettings:
    points: int

    def __post_init__(self) -> None:
        require(self.points >= 1, "method.*.points", self.points, "at least 1")


@dataclass(frozen=True)
class MethodSettings:
    hull: HullSettings
    hull_rgb: HullRgbSettings
    ball: SampleSettings
    box: SampleSettings
    oracle: SampleSettings


@dataclass(frozen=True)
class ReconstructParams:
    time_limit_s: float

    def __post_init__(self) -> None:
        require(self.time_limit_s > 0, "reconstruct.time_limit_s", self.time_limit_s, "more than 0")


@dataclass(frozen=True)
class EvaluateParams:
    points: int
    dense: int
    cap: int
    rig: int
    rig_radius: float
    hidden: float
    fscore: float

    def __post_init__(self) -> None:
        require(self.points >= 1, "evaluate.points", self.points, "at least 1")
        require(self.dense >= self.points, "evaluate.dense", self.dense, f"at least {self.points}")
        require(self.cap >= self.points, "evaluate.cap", self.cap, f"at least {self.points}")
        require(self.rig >= 1, "evaluate.rig", self.rig, "at least 1")
        require(self.rig_radius > 1, "evaluate.rig_radius", self.rig_radius, "more than 1")
        require(0 < self.hidden < 1, "evaluate.hidden", self.hidden, "in (0, 1)")
        require(0 < self.fscore < 1, "evaluate.fscore", self.fscore, "in (0, 1)")


@dataclass(frozen=True)
class ReportParams:
    resamples: int
    interval: float
    sheet_parts: int

    def __post_init__(self) -> None:
        require(self.resamples >= 1, "report.resamples", self.resamples, "at least 1")
        require(0 < self.interval < 1, "report.interval", self.interval, "in (0, 1)")
        require(self.sheet_parts >= 1, "report.sheet_parts", self.sheet_parts, "at least 1")


@dataclass(frozen=True)
class Params:
    preset: str
    seed: int
    on_failure: Literal["strict", "report"]
    parts: PartsParams
    views: ViewsParams
    split: SplitParams
    methods: list[str]
    method: MethodSettings
    reconstruct: ReconstructParams
    evaluate: EvaluateParams
    report: ReportParams

    def __post_init__(self) -> None:
        known = list(MethodSettings.__dataclass_fields__)
        require(len(self.methods) > 0, "methods", self.methods, "a list of at least one method")
        for name in self.methods:
            require(name in known, "methods", name, f"one of {', '.join(known)}")
