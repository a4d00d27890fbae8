"""params.yaml as a whole, and its smaller sections."""

from dataclasses import dataclass
from typing import Annotated, Literal

from industnerf.schema.methods import MethodSettings
from industnerf.schema.parts import PartsParams
from industnerf.schema.rules import (
    Count,
    CountOr0,
    InnerShare,
    Positive,
    Rule,
    Share,
    at_least,
    one_or_more,
    require,
)
from industnerf.schema.views import ViewsParams

OUTSIDE = Rule(lambda radius: radius > 1, "above 1: outside of the part's bounding ball")
METHODS = tuple(MethodSettings.__dataclass_fields__)
KNOWN = Rule(lambda name: name in METHODS, f"one of {', '.join(METHODS)}")


@dataclass(frozen=True)
class SplitParams:
    dev_share: Share
    folds: Annotated[int, at_least(2)]
    hold_out: Literal["family", "part", "none"]


@dataclass(frozen=True)
class TrainParams:
    time_limit_s: Positive


@dataclass(frozen=True)
class ReconstructParams:
    views: CountOr0
    time_limit_s: Positive


@dataclass(frozen=True)
class EvaluateParams:
    points: Count
    dense: int
    cap: int
    rig: Count
    rig_radius: Annotated[float, OUTSIDE]
    hidden: InnerShare
    fscore: InnerShare
    tolerances_mm: list[Positive]

    def __post_init__(self) -> None:
        for key in ("dense", "cap"):
            value = getattr(self, key)
            require(value >= self.points, key, value, f"at least the {self.points} of points")


@dataclass(frozen=True)
class ReportParams:
    resamples: Count
    interval: InnerShare
    sheet_parts: Count


@dataclass(frozen=True)
class Params:
    preset: str
    seed: int
    on_failure: Literal["strict", "report"]
    parts: PartsParams
    views: ViewsParams
    split: SplitParams
    methods: Annotated[list[Annotated[str, KNOWN]], one_or_more("method")]
    method: MethodSettings
    train: TrainParams
    reconstruct: ReconstructParams
    evaluate: EvaluateParams
    report: ReportParams

    def __post_init__(self) -> None:
        most, given = self.views.count, self.reconstruct.views
        once = len(set(self.methods)) == len(self.methods)
        require(once, "methods", self.methods, "a list of methods, each of them once")
        require(given <= most, "reconstruct.views", given, f"at most the {most} of views.count")
