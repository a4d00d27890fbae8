"""`method.industnerf` and its variants: `_plus`, `_depth`, `_shared` and `nerf`.

All have the keys of `industnerf`; three have some of their own.
"""

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
    """One level of the point cloud; levels go from coarse to fine."""

    steps: NonNegativeInt
    image_px: ImagePx
    points: Annotated[int, at_least(1000)]


@dataclass(frozen=True)
class WarmUpSettings:
    """Training on a grid of half the resolution, before the first level."""

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
    encoder_update_levels: PositiveInt
    lr: PositiveFloat
    skip_lr: PositiveFloat
    encoder_lr: PositiveFloat
    density_scale: PositiveFloat
    prune_fraction: Fraction


@dataclass(frozen=True)
class ResidualSettings:
    """Free density and color of each point: an addition to the paper."""

    enabled: bool
    density_lr: NonNegativeFloat
    color_lr: NonNegativeFloat


@dataclass(frozen=True)
class BetaSchedule:
    """Softness of a surface that is given by signed distances: R4 `sdf`."""

    start: PositiveFloat
    end: PositiveFloat
    render: PositiveFloat

    def __post_init__(self) -> None:
        require(self.end <= self.start, "end", self.end, f"at most start, {self.start:g}")


@dataclass(frozen=True)
class FusionSettings:
    """Fusion of the depth maps of all views: R11 `tsdf_fusion`."""

    grid_res: GridRes
    truncation: Annotated[float, at_least(1, " cell")]
    points: PositiveInt


@dataclass(frozen=True)
class IndustnerfSettings:
    """`industnerf` and `nerf`: what every variant has."""

    readings: Readings
    grid_res: GridRes
    warm_up: WarmUpSettings
    levels: Annotated[list[LevelSettings], non_empty("level")]
    refine: Literal["inverse_transform", "subdivide"]
    view_weights_interval: NonNegativeInt
    network: NetworkSettings
    residual: ResidualSettings
    beta: BetaSchedule
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
    image_noise: Fraction
    min_confidence: Fraction
    fusion: FusionSettings
    surface_spacing: Annotated[float, in_interval("(0, 1)")]

    def __post_init__(self) -> None:
        is_learned = self.network.enabled or self.residual.enabled
        rule = "true, or residual.enabled: else nothing is learned"
        require(is_learned, "network.enabled", False, rule)
        steps = self.levels[0].steps
        require(steps >= 1, "levels[0].steps", steps, "at least 1: else nothing is learned")
        can_halve = not self.warm_up.steps or self.grid_res % 2 == 0
        require(can_halve, "grid_res", self.grid_res, "even: the warm-up has half of it")
        is_sdf = self.readings.density_activation == "sdf"
        is_bounded = is_sdf or self.density_bias < self.max_raw_density
        require(is_bounded, "density_bias", self.density_bias, "below max_raw_density")


@dataclass(frozen=True)
class IndustnerfDepthSettings(IndustnerfSettings):
    """`industnerf_depth`."""

    depth_weight: NonNegativeFloat


@dataclass(frozen=True)
class PretrainingSettings:
    """What E and N learn from other parts: R14 `pretrained`."""

    parts: PositiveInt
    epochs: PositiveInt


@dataclass(frozen=True)
class IndustnerfSharedSettings(IndustnerfSettings):
    """`industnerf_shared`."""

    pretraining: PretrainingSettings


@dataclass(frozen=True)
class SdfInitSettings(SpaceCarvingSettings):
    """Initial distances from the photo hull."""

    enabled: bool
    initial_max_depth: PositiveFloat


@dataclass(frozen=True)
class SdfSettings:
    """A signed distance at each point, kept inside the visual hull."""

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
        is_valid = self.enabled or not self.init.enabled
        require(is_valid, "init.enabled", True, "false where enabled is false")


@dataclass(frozen=True)
class DecaySettings:
    """A value that falls over all steps, in equal ratios."""

    start: PositiveFloat
    end: PositiveFloat

    def __post_init__(self) -> None:
        require(self.end <= self.start, "end", self.end, f"at most start, {self.start:g}")


@dataclass(frozen=True)
class PolishSettings:
    """The surface on a grid of signed distances, under fitted light."""

    enabled: bool
    max_nodes: Annotated[int, at_least(10_000)]
    steps: NonNegativeInt
    rays_per_step: PositiveInt
    opaque_fraction: Annotated[float, in_interval("[0, 1)")]
    step_size: Annotated[float, in_interval("(0, 2]", " cells")]
    beta: DecaySettings
    lr: DecaySettings
    curvature_rate: NonNegativeFloat
    relax_rate: Fraction
    light_pixels: Annotated[int, at_least(1000)]
    light_interval: NonNegativeInt
    max_light_outliers: Fraction
    points: PositiveInt


@dataclass(frozen=True)
class CaveSettings:
    """Hollows of the trained field that are filled where the pictures do not show them."""

    max_cost_ratio: NonNegativeFloat
    min_unseen_fraction: Fraction


@dataclass(frozen=True)
class RecessSettings:
    """Recesses along the normals of faces, cut where the pictures show mouths in these."""

    faces: NonNegativeInt
    rays_per_trial: PositiveInt
    max_cost_ratio: Fraction
    max_gap_cost_ratio: Fraction


@dataclass(frozen=True)
class OpeningSettings:
    """Planes that replace the surface where it does not explain flat regions of the pictures."""

    rounds: NonNegativeInt
    trials: PositiveInt
    rays_per_trial: PositiveInt
    min_flat_fraction: Fraction
    max_cost_ratio: Fraction


@dataclass(frozen=True)
class IndustnerfPlusSettings(IndustnerfSettings):
    """`industnerf_plus`: its additions to the paper."""

    silhouette_carving: bool
    background_tolerance: Fraction
    max_grid_points: NonNegativeInt
    sdf: SdfSettings
    polish: PolishSettings
    caves: CaveSettings
    recesses: RecessSettings
    openings: OpeningSettings

    def __post_init__(self) -> None:
        super().__post_init__()
        is_carved, points = self.silhouette_carving, self.max_grid_points
        rule = "0 where silhouette_carving is false"
        require(points == 0 or is_carved, "max_grid_points", points, rule)
        has_free_points = self.residual.enabled and not self.network.enabled
        is_sdf = self.readings.density_activation == "sdf"
        has_sdf_grid = is_sdf and is_carved and has_free_points
        rule = (
            "false without readings.density_activation sdf, silhouette_carving and "
            "residual.enabled true, network.enabled false"
        )
        require(not self.sdf.enabled or has_sdf_grid, "sdf.enabled", True, rule)
        rule = "1 where sdf.enabled is true"
        require(not self.sdf.enabled or len(self.levels) == 1, "levels", len(self.levels), rule)
        rule = "false where sdf.enabled is false"
        require(self.sdf.enabled or not self.polish.enabled, "polish.enabled", True, rule)
