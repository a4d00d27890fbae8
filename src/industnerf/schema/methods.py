"""`method`: the settings of every method."""

from dataclasses import dataclass
from typing import Literal

from industnerf.schema.industnerf import IndustnerfSettings
from industnerf.schema.learning import AugmentSettings, TrainingSettings
from industnerf.schema.rules import require


@dataclass(frozen=True)
class R2n2Settings:
    size: Literal["full", "cpu", "tiny"]
    image_px: int
    divisor: int
    pictures: int
    views: int
    threshold: float
    points: int
    training: TrainingSettings
    augment: AugmentSettings

    def __post_init__(self) -> None:
        at = "method.r2n2"
        require(self.image_px >= 16, f"{at}.image_px", self.image_px, "at least 16")
        require(32 % self.divisor == 0, f"{at}.divisor", self.divisor, "1, 2, 4, 8, 16 or 32")
        require(self.pictures >= 1, f"{at}.pictures", self.pictures, "at least 1")
        require(self.views >= 1, f"{at}.views", self.views, "at least 1")
        require(0 < self.threshold < 1, f"{at}.threshold", self.threshold, "in (0, 1)")
        require(self.points >= 1, f"{at}.points", self.points, "at least 1")


@dataclass(frozen=True)
class AtlasNetSettings:
    size: Literal["full", "cpu", "tiny"]
    image_px: int
    views: int
    width: int
    latent: int
    hidden: int
    patches: int
    patch_points: int
    grid: int
    answers: int
    points: int
    phases: list[float]
    training: TrainingSettings
    augment: AugmentSettings

    def __post_init__(self) -> None:
        at = "method.atlasnet"
        require(self.image_px >= 16, f"{at}.image_px", self.image_px, "at least 16")
        for key in ("views", "width", "latent", "hidden", "patches", "patch_points"):
            require(getattr(self, key) >= 1, f"{at}.{key}", getattr(self, key), "at least 1")
        require(self.grid >= 2, f"{at}.grid", self.grid, "at least 2")
        for key in ("answers", "points"):
            require(getattr(self, key) >= 1, f"{at}.{key}", getattr(self, key), "at least 1")
        good = len(self.phases) == 3 and min(self.phases) > 0
        require(good, f"{at}.phases", self.phases, "three positive numbers")


@dataclass(frozen=True)
class OccupancySettings:
    size: Literal["full", "cpu", "tiny"]
    image_px: int
    views: int
    encoder_width: int
    code: int
    decoder_width: int
    blocks: int
    padding: float
    pool: int
    queries: int
    training: TrainingSettings
    augment: AugmentSettings
    answers: int
    threshold: float
    cells: int
    subdivisions: int
    points: int

    def __post_init__(self) -> None:
        at = "method.occupancy"
        counts = ("views", "encoder_width", "code", "decoder_width", "blocks", "pool", "queries")
        for name in (*counts, "answers", "cells", "points"):
            require(getattr(self, name) >= 1, f"{at}.{name}", getattr(self, name), "at least 1")
        require(self.image_px >= 32, f"{at}.image_px", self.image_px, "at least 32")
        require(self.padding >= 0, f"{at}.padding", self.padding, "at least 0")
        require(0 < self.threshold < 1, f"{at}.threshold", self.threshold, "in (0, 1)")
        require(0 <= self.subdivisions <= 4, f"{at}.subdivisions", self.subdivisions, "in [0, 4]")


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
class CarveSettings:
    grid_res: int
    tolerance: float
    threshold: float
    footprint: float
    facing: float
    outliers: float
    views: int
    sweeps: int
    points: int

    def __post_init__(self) -> None:
        of = "method.carve"
        whole = 32 <= self.grid_res <= 512 and self.grid_res % 8 == 0
        require(whole, f"{of}.grid_res", self.grid_res, "a multiple of 8 in [32, 512]")
        require(0 <= self.tolerance < 1, f"{of}.tolerance", self.tolerance, "in [0, 1)")
        require(0 <= self.threshold < 1, f"{of}.threshold", self.threshold, "in [0, 1)")
        require(0 < self.footprint <= 8, f"{of}.footprint", self.footprint, "in (0, 8] cells")
        require(-1 <= self.facing < 1, f"{of}.facing", self.facing, "in [-1, 1)")
        require(0 <= self.outliers < 0.5, f"{of}.outliers", self.outliers, "in [0, 0.5)")
        require(self.views >= 2, f"{of}.views", self.views, "at least 2")
        require(self.sweeps >= 0, f"{of}.sweeps", self.sweeps, "at least 0")
        require(self.points >= 1, f"{of}.points", self.points, "at least 1")


@dataclass(frozen=True)
class TsdfSettings:
    grid_res: int
    truncation: float
    points: int

    def __post_init__(self) -> None:
        require(8 <= self.grid_res <= 512, "method.tsdf.grid_res", self.grid_res, "in [8, 512]")
        require(self.truncation >= 1, "method.tsdf.truncation", self.truncation, "at least 1 cell")
        require(self.points >= 1, "method.tsdf.points", self.points, "at least 1")


@dataclass(frozen=True)
class SampleSettings:
    points: int

    def __post_init__(self) -> None:
        require(self.points >= 1, "method.*.points", self.points, "at least 1")


@dataclass(frozen=True)
class RetrievalSettings:
    views: int
    image_px: int
    points: int

    def __post_init__(self) -> None:
        at = "method.retrieval"
        require(self.views >= 1, f"{at}.views", self.views, "at least 1")
        require(self.image_px >= 16, f"{at}.image_px", self.image_px, "at least 16")
        require(self.points >= 1, f"{at}.points", self.points, "at least 1")


@dataclass(frozen=True)
class MeanShapeSettings:
    grid_res: int
    points: int

    def __post_init__(self) -> None:
        require(self.grid_res >= 2, "method.mean_shape.grid_res", self.grid_res, "at least 2")
        require(self.points >= 1, "method.mean_shape.points", self.points, "at least 1")


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
            encoder = getattr(self, name).readings.encoder
            key = f"method.{name}.readings.encoder"
            require(encoder != "shared", key, encoder, "another: industnerf_shared has that one")
        learns = self.industnerf_shared
        key = "method.industnerf_shared"
        encoder = learns.readings.encoder
        require(encoder == "shared", f"{key}.readings.encoder", encoder, "shared")
        steps = learns.warm_up.steps
        require(steps >= 1, f"{key}.warm_up.steps", steps, "at least 1: E learns in warm-ups")
