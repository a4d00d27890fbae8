"""`method.industnerf`, `_plus`, `_depth`, `_shared` and `nerf`: the same keys, other values."""

from dataclasses import dataclass
from typing import Annotated, Literal

from industnerf.schema.carving import SpaceCarvingSettings
from industnerf.schema.readings import Readings
from industnerf.schema.validators import (
    Fraction,
    GridRes,
    ImagePx,
    NonNegativeFloat,
    NonNegativeInt,
    PositiveFloat,
    PositiveInt,
    Rule,
    at_least,
    in_interval,
    non_empty,
    require,
)

RendererName = Literal["compiled", "torch"]
MULTIPLE_OF_6 = Rule(
    lambda count: count > 0 and count % 6 == 0, "a multiple of 6: sine, cosine, 3 axes"
)
SpacingUnits = Annotated[float, in_interval("(0, 4]", " spacings")]


@dataclass(frozen=True)
class LevelSettings:
    """One resolution of the cloud, from coarse to fine."""

    steps: NonNegativeInt
    image_px: ImagePx
    points: Annotated[int, at_least(1000)]


@dataclass(frozen=True)
class WarmUpSettings:
    """Steps on a grid of half the resolution, before the first level."""

    steps: NonNegativeInt
    image_px: ImagePx


@dataclass(frozen=True)
class NetworkSettings:
    """E and N of section 3.1."""

    enabled: bool
    feature_channels: PositiveInt
    encoder_width: PositiveInt
    rgb_skip: bool
    encoding_channels: Annotated[int, MULTIPLE_OF_6]
    encoding_alpha: PositiveFloat
    encoding_beta: PositiveFloat
    hidden_dim: PositiveInt
    hidden_layers: PositiveInt
    encoder_update_interval: PositiveInt
    encoder_update_views: PositiveInt
    lr: PositiveFloat
    skip_lr: PositiveFloat
    encoder_lr: PositiveFloat
    density_scale: PositiveFloat
    prune_fraction: Fraction


@dataclass(frozen=True)
class PretrainingSettings:
    """What E and N learn from other parts: R14 `shared`."""

    parts: PositiveInt
    epochs: PositiveInt


@dataclass(frozen=True)
class ResidualSettings:
    """What is learned for each point by itself: an addition to the paper."""

    enabled: bool
    density_lr: NonNegativeFloat
    color_lr: NonNegativeFloat


@dataclass(frozen=True)
class BetaSchedule:
    """Of a surface that is given by distances: R4."""

    start: PositiveFloat
    end: PositiveFloat
    render: PositiveFloat

    def __post_init__(self) -> None:
        require(self.end <= self.start, "end", self.end, f"at most start, {self.start:g}")


@dataclass(frozen=True)
class SdfInitSettings(SpaceCarvingSettings):
    """Of a relief that starts at the photo hull."""

    enabled: bool
    initial_max_depth: PositiveFloat


@dataclass(frozen=True)
class SdfSettings:
    """A surface carved out of the visual hull: an addition to the paper."""

    enabled: bool
    init: SdfInitSettings
    lr: PositiveFloat
    relax_rate: Fraction
    relax_rate_low_confidence: Fraction
    relax_max_depth: NonNegativeFloat
    max_depth_factor: Annotated[float, at_least(1)]
    median_filter_interval: NonNegativeInt
    median_filter_start: Annotated[float, in_interval("[0, 1]")]

    def __post_init__(self) -> None:
        require(
            self.enabled or not self.init.enabled,
            "init.enabled",
            True,
            "false where enabled is false",
        )


@dataclass(frozen=True)
class ColorRefinementSettings:
    """Colors alone, once the surface is found: an addition to the paper."""

    steps: NonNegativeInt
    lr: PositiveFloat


@dataclass(frozen=True)
class FusionSettings:
    """Of the depths that all views see: reading `tsdf_fusion` of R11."""

    grid_res: GridRes
    truncation: Annotated[float, at_least(1, " cell")]
    points: PositiveInt


@dataclass(frozen=True)
class IndustnerfSettings:
    readings: Readings
    grid_res: GridRes
    max_grid_points: NonNegativeInt
    warm_up: WarmUpSettings
    levels: Annotated[list[LevelSettings], non_empty("level")]
    refine: Literal["inverse_transform", "subdivide"]
    silhouette_carving: bool
    background_tolerance: Fraction
    network: NetworkSettings
    pretraining: PretrainingSettings
    residual: ResidualSettings
    beta: BetaSchedule
    sdf: SdfSettings
    color_refinement: ColorRefinementSettings
    density_bias: float
    max_raw_density: float
    rays_per_step: PositiveInt
    step_size: SpacingUnits
    fine_step_size: SpacingUnits
    surface_px: ImagePx
    neighbor_radius: Annotated[float, in_interval("(0, 8]", " spacings")]
    neighbors: Annotated[int, in_interval("[1, 64]")]
    early_stop_transmittance: Fraction
    renderer: RendererName
    opacity_weight: NonNegativeFloat
    binary_opacity_weight: NonNegativeFloat
    depth_weight: NonNegativeFloat
    image_noise: Fraction
    min_confidence: Fraction
    fusion: FusionSettings
    surface_spacing: Annotated[float, in_interval("(0, 1)")]

    def __post_init__(self) -> None:
        is_learned = self.network.enabled or self.residual.enabled
        require(
            is_learned,
            "network.enabled",
            False,
            "true, or residual.enabled: else nothing is learned",
        )
        steps = self.levels[0].steps
        require(steps >= 1, "levels[0].steps", steps, "at least 1: else nothing is learned")
        can_halve = not self.warm_up.steps or self.grid_res % 2 == 0
        require(can_halve, "grid_res", self.grid_res, "even: the warm-up has half of it")
        is_carved = self.max_grid_points == 0 or self.silhouette_carving
        require(
            is_carved,
            "max_grid_points",
            self.max_grid_points,
            "0 where silhouette_carving is false",
        )
        is_sdf_valid = not self.sdf.enabled or self._has_sdf_grid()
        requirement = (
            "readings.density_activation sdf, silhouette_carving and residual.enabled true, "
            "network.enabled false"
        )
        require(is_sdf_valid, "sdf.enabled", True, f"false without {requirement}, refine subdivide")
        is_refinable = not self.color_refinement.steps or self._has_free_points()
        requirement = "0 without residual.enabled true and network.enabled false"
        require(is_refinable, "color_refinement.steps", self.color_refinement.steps, requirement)
        is_bounded = (
            self.readings.density_activation == "sdf" or self.density_bias < self.max_raw_density
        )
        require(is_bounded, "density_bias", self.density_bias, "below max_raw_density")

    def _has_free_points(self) -> bool:
        """Whether the field is what each point learns by itself."""
        return self.residual.enabled and not self.network.enabled

    def _has_sdf_grid(self) -> bool:
        """Whether each point has a distance of its own, and stays in its place in a grid."""
        has_fixed_grid = self.refine == "subdivide" or len(self.levels) == 1
        return (
            self.readings.density_activation == "sdf"
            and self.silhouette_carving
            and self._has_free_points()
            and has_fixed_grid
        )
