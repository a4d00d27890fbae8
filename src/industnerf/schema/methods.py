"""`method`: the settings of every method."""

from dataclasses import dataclass
from typing import Annotated, Literal

from industnerf.schema.carving import SpaceCarvingSettings
from industnerf.schema.industnerf import (
    IndustnerfDepthSettings,
    IndustnerfPlusSettings,
    IndustnerfSettings,
    IndustnerfSharedSettings,
)
from industnerf.schema.training import AugmentSettings, OutputAxes, QueryAxes, TrainingSettings
from industnerf.schema.validators import (
    Fraction,
    GridRes,
    ImagePx,
    PositiveInt,
    Rule,
    at_least,
    in_interval,
    require,
)

Size = Literal["full", "cpu", "tiny"]
FROM_STRATA = at_least(4, ": some of them inside, near and far")
DIVISOR = Rule(lambda divisor: divisor > 0 and 32 % divisor == 0, "1, 2, 4, 8, 16 or 32")


@dataclass(frozen=True)
class R2n2Settings:
    size: Size
    image_px: ImagePx
    channel_divisor: Annotated[int, DIVISOR]
    max_views: PositiveInt
    points: PositiveInt
    pretraining: TrainingSettings
    training: TrainingSettings
    augment: AugmentSettings


@dataclass(frozen=True)
class AtlasNetSettings:
    size: Size
    output_axes: OutputAxes
    image_px: ImagePx
    train_views: PositiveInt
    encoder_width: PositiveInt
    latent_dim: PositiveInt
    hidden_dim: PositiveInt
    patches: PositiveInt
    patch_points: PositiveInt
    target_points: PositiveInt
    grid_res: Annotated[int, at_least(2)]
    eval_views: PositiveInt
    points: PositiveInt
    pretraining: TrainingSettings
    training: TrainingSettings
    augment: AugmentSettings


@dataclass(frozen=True)
class OccupancySettings:
    size: Size
    query_axes: QueryAxes
    image_px: Annotated[int, at_least(32, " px")]
    train_views: PositiveInt
    encoder_width: PositiveInt
    latent_dim: PositiveInt
    decoder_width: PositiveInt
    decoder_blocks: PositiveInt
    points_per_part: Annotated[int, FROM_STRATA]
    points_subsample: Annotated[int, FROM_STRATA]
    pretraining: TrainingSettings
    training: TrainingSettings
    augment: AugmentSettings
    eval_views: PositiveInt
    resolution_0: PositiveInt
    upsampling_steps: Annotated[int, in_interval("[0, 4]")]
    points: PositiveInt


@dataclass(frozen=True)
class HullSettings:
    cell_px: Annotated[float, in_interval("(0, 8]", " px")]
    points: PositiveInt


@dataclass(frozen=True)
class HullRgbSettings:
    hull: HullSettings
    background_tolerance: Fraction


@dataclass(frozen=True)
class CarveSettings(SpaceCarvingSettings):
    background_tolerance: Fraction
    points: PositiveInt


@dataclass(frozen=True)
class TsdfSettings:
    grid_res: GridRes
    truncation: Annotated[float, at_least(1, " cell")]
    points: PositiveInt


@dataclass(frozen=True)
class SampleSettings:
    points: PositiveInt


@dataclass(frozen=True)
class RetrievalSettings:
    views: PositiveInt
    image_px: ImagePx
    points: PositiveInt


@dataclass(frozen=True)
class MeanShapeSettings:
    grid_res: Annotated[int, at_least(2)]
    points: PositiveInt


@dataclass(frozen=True)
class MethodSettings:
    industnerf: IndustnerfSettings
    industnerf_plus: IndustnerfPlusSettings
    industnerf_depth: IndustnerfDepthSettings
    industnerf_shared: IndustnerfSharedSettings
    nerf: IndustnerfSettings
    r2n2: R2n2Settings
    atlasnet: AtlasNetSettings
    occupancy: OccupancySettings
    hull: HullSettings
    hull_rgb: HullRgbSettings
    carve: CarveSettings
    tsdf: TsdfSettings
    retrieval: RetrievalSettings
    retrieval_procedural: RetrievalSettings
    mean_shape: MeanShapeSettings
    mean_shape_procedural: SampleSettings
    ball: SampleSettings
    box: SampleSettings
    oracle: SampleSettings

    def __post_init__(self) -> None:
        for name in ("industnerf", "industnerf_plus", "industnerf_depth", "nerf"):
            encoder, key = getattr(self, name).readings.encoder, f"{name}.readings.encoder"
            rule = "another: industnerf_shared has that one"
            require(encoder != "pretrained", key, encoder, rule)
        shared, name = self.industnerf_shared, "industnerf_shared"
        encoder, steps = shared.readings.encoder, shared.warm_up.steps
        require(encoder == "pretrained", f"{name}.readings.encoder", encoder, "pretrained")
        rule = "true: E and N are what is learned"
        require(shared.network.enabled, f"{name}.network.enabled", False, rule)
        rule = "at least 1: E and N learn in warm-ups"
        require(steps >= 1, f"{name}.warm_up.steps", steps, rule)
