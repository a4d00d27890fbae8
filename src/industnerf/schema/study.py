"""params.yaml as a whole, and its smaller sections."""

from dataclasses import dataclass
from typing import Literal

from industnerf.schema.methods import MethodSettings
from industnerf.schema.parts import PartsParams
from industnerf.schema.rules import require
from industnerf.schema.views import ViewsParams


@dataclass(frozen=True)
class SplitParams:
    dev_share: float
    folds: int
    hold_out: Literal["family", "part", "none"]

    def __post_init__(self) -> None:
        require(0 <= self.dev_share < 1, "split.dev_share", self.dev_share, "in [0, 1)")
        require(self.folds >= 2, "split.folds", self.folds, "at least 2")


@dataclass(frozen=True)
class TrainParams:
    time_limit_s: float

    def __post_init__(self) -> None:
        require(self.time_limit_s > 0, "train.time_limit_s", self.time_limit_s, "more than 0")


@dataclass(frozen=True)
class ReconstructParams:
    views: int
    time_limit_s: float

    def __post_init__(self) -> None:
        require(self.views >= 0, "reconstruct.views", self.views, "at least 0")
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
    tolerances_mm: list[float]

    def __post_init__(self) -> None:
        require(self.points >= 1, "evaluate.points", self.points, "at least 1")
        require(self.dense >= self.points, "evaluate.dense", self.dense, f"at least {self.points}")
        require(self.cap >= self.points, "evaluate.cap", self.cap, f"at least {self.points}")
        require(self.rig >= 1, "evaluate.rig", self.rig, "at least 1")
        require(self.rig_radius > 1, "evaluate.rig_radius", self.rig_radius, "more than 1")
        require(0 < self.hidden < 1, "evaluate.hidden", self.hidden, "in (0, 1)")
        require(0 < self.fscore < 1, "evaluate.fscore", self.fscore, "in (0, 1)")
        for limit in self.tolerances_mm:
            require(limit > 0, "evaluate.tolerances_mm", limit, "above 0")


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
    train: TrainParams
    reconstruct: ReconstructParams
    evaluate: EvaluateParams
    report: ReportParams

    def __post_init__(self) -> None:
        known = list(MethodSettings.__dataclass_fields__)
        require(len(self.methods) > 0, "methods", self.methods, "a list of at least one method")
        for name in self.methods:
            require(name in known, "methods", name, f"one of {', '.join(known)}")
        most = self.views.count
        given = self.reconstruct.views
        require(given <= most, "reconstruct.views", given, f"at most the {most} of views.count")
