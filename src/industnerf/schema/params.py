"""params.yaml as a whole, and its smaller sections."""

from dataclasses import dataclass
from typing import Annotated, Literal

from industnerf.schema.methods import MethodSettings
from industnerf.schema.parts import PartsParams
from industnerf.schema.validators import (
    Fraction,
    ImagePx,
    NonNegativeInt,
    OpenFraction,
    PositiveFloat,
    PositiveInt,
    Rule,
    at_least,
    non_empty,
    one_of,
    require,
)
from industnerf.schema.views import ViewsParams

ABOVE_1 = Rule(lambda radius: radius > 1, "above 1: outside of the part's bounding ball")
METHODS = tuple(MethodSettings.__dataclass_fields__)
KNOWN_METHOD = one_of(METHODS)


@dataclass(frozen=True)
class SplitParams:
    dev_fraction: Fraction
    folds: Annotated[int, at_least(2)]
    hold_out: Literal["family", "part", "none"]


@dataclass(frozen=True)
class ProceduralParams:
    solids: NonNegativeInt
    kinds: Literal["abstract", "all"]
    views: PositiveInt
    image_px: ImagePx


@dataclass(frozen=True)
class PretrainParams:
    weights: Literal["shipped", "trained", "none"]
    time_limit_s: PositiveFloat


@dataclass(frozen=True)
class TrainParams:
    time_limit_s: PositiveFloat


@dataclass(frozen=True)
class ReconstructParams:
    views: NonNegativeInt
    time_limit_s: PositiveFloat


@dataclass(frozen=True)
class EvaluateParams:
    points: PositiveInt
    dense_samples: int
    max_points: int
    visibility_views: PositiveInt
    visibility_radius: Annotated[float, ABOVE_1]
    occlusion_margin: OpenFraction
    fscore_threshold: OpenFraction
    tolerances_mm: list[PositiveFloat]

    def __post_init__(self) -> None:
        for key in ("dense_samples", "max_points"):
            value = getattr(self, key)
            require(value >= self.points, key, value, f"at least the {self.points} of points")


@dataclass(frozen=True)
class ReportParams:
    bootstrap_resamples: PositiveInt
    confidence_level: OpenFraction
    contact_sheet_parts: PositiveInt


@dataclass(frozen=True)
class Params:
    preset: str
    seed: int
    on_failure: Literal["strict", "report"]
    parts: PartsParams
    views: ViewsParams
    split: SplitParams
    methods: Annotated[list[Annotated[str, KNOWN_METHOD]], non_empty("method")]
    method: MethodSettings
    procedural: ProceduralParams
    pretrain: PretrainParams
    train: TrainParams
    reconstruct: ReconstructParams
    evaluate: EvaluateParams
    report: ReportParams

    def __post_init__(self) -> None:
        view_count, method_views = self.views.count, self.reconstruct.views
        is_unique = len(set(self.methods)) == len(self.methods)
        require(is_unique, "methods", self.methods, "a list of methods, each of them once")
        require(
            method_views <= view_count,
            "reconstruct.views",
            method_views,
            f"at most the {view_count} of views.count",
        )
        solids, weights = self.procedural.solids, self.pretrain.weights
        rule = "at least 1: pretrain.weights is trained, and they are what it learns from"
        require(solids > 0 or weights != "trained", "procedural.solids", solids, rule)
        for name in ("r2n2", "atlasnet", "occupancy"):
            network, key = getattr(self.method, name), f"method.{name}"
            steps, more = network.pretraining.max_steps, network.training.max_steps
            require(steps > 0, f"{key}.pretraining.max_steps", steps, "at least 1")
            rule = "at least 1 where pretrain.weights is none: nothing else trains the network"
            require(more > 0 or weights != "none", f"{key}.training.max_steps", more, rule)
