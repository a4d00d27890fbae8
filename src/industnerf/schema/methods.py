"""`method`: the settings of every method."""

from dataclasses import dataclass
from typing import Annotated, Literal

from industnerf.schema.carving import SpaceCarvingSettings
from industnerf.schema.industnerf import IndustnerfSettings
from industnerf.schema.learning import AugmentSettings, Frame, TrainingSettings
from industnerf.schema.rules import (
    Count,
    GridRes,
    ImagePx,
    InnerShare,
    PositiveOr0,
    Rule,
    Share,
    at_least,
    require,
    within,
)

Size = Literal["full", "cpu", "tiny"]
DIVISOR = Rule(lambda divisor: divisor > 0 and 32 % divisor == 0, "1, 2, 4, 8, 16 or 32")
PHASES = Rule(lambda shares: len(shares) == 3 and min(shares) > 0, "three positive numbers")


@dataclass(frozen=True)
class R2n2Settings:
    size: Size
    image_px: ImagePx
    divisor: Annotated[int, DIVISOR]
    pictures: Count
    views: Count
    threshold: InnerShare
    points: Count
    training: TrainingSettings
    augment: AugmentSettings


@dataclass(frozen=True)
class AtlasNetSettings:
    size: Size
    frame: Frame
    image_px: ImagePx
    views: Count
    width: Count
    latent: Count
    hidden: Count
    patches: Count
    patch_points: Count
    grid: Annotated[int, at_least(2)]
    answers: Count
    points: Count
    phases: Annotated[list[float], PHASES]
    training: TrainingSettings
    augment: AugmentSettings


@dataclass(frozen=True)
class OccupancySettings:
    size: Size
    frame: Frame
    image_px: Annotated[int, at_least(32, " px")]
    views: Count
    encoder_width: Count
    code: Count
    decoder_width: Count
    blocks: Count
    padding: PositiveOr0
    pool: Count
    queries: Count
    training: TrainingSettings
    augment: AugmentSettings
    answers: Count
    threshold: InnerShare
    cells: Count
    subdivisions: Annotated[int, within("[0, 4]")]
    points: Count


@dataclass(frozen=True)
class HullSettings:
    cell_px: Annotated[float, within("(0, 8]", " px")]
    points: Count


@dataclass(frozen=True)
class HullRgbSettings:
    hull: HullSettings
    tolerance: Share


@dataclass(frozen=True)
class CarveSettings(SpaceCarvingSettings):
    tolerance: Share
    points: Count


@dataclass(frozen=True)
class TsdfSettings:
    grid_res: GridRes
    truncation: Annotated[float, at_least(1, " cell")]
    points: Count


@dataclass(frozen=True)
class SampleSettings:
    points: Count


@dataclass(frozen=True)
class RetrievalSettings:
    views: Count
    image_px: ImagePx
    points: Count


@dataclass(frozen=True)
class MeanShapeSettings:
    grid_res: Annotated[int, at_least(2)]
    points: Count


@dataclass(frozen=True)
class MethodSettings:
    industnerf: IndustnerfSettings
    industnerf_plus: IndustnerfSettings
    industnerf_depth: IndustnerfSettings
    industnerf_shared: IndustnerfSettings
    nerf: IndustnerfSettings
    r2n2: R2n2Settings
    atlasnet: AtlasNetSettings
    occupancy: OccupancySettings
    hull: HullSettings
    hull_rgb: HullRgbSettings
    carve: CarveSettings
    tsdf: TsdfSettings
    retrieval: RetrievalSettings
    mean_shape: MeanShapeSettings
    ball: SampleSettings
    box: SampleSettings
    oracle: SampleSettings

    def __post_init__(self) -> None:
        for name in ("industnerf", "industnerf_plus", "industnerf_depth", "nerf"):
            encoder, key = getattr(self, name).readings.encoder, f"{name}.readings.encoder"
            require(encoder != "shared", key, encoder, "another: industnerf_shared has that one")
        learns, name = self.industnerf_shared, "industnerf_shared"
        encoder, steps = learns.readings.encoder, learns.warm_up.steps
        require(encoder == "shared", f"{name}.readings.encoder", encoder, "shared")
        require(
            learns.network.use, f"{name}.network.use", False, "true: E and N are what is learned"
        )
        require(steps >= 1, f"{name}.warm_up.steps", steps, "at least 1: E learns in warm-ups")
