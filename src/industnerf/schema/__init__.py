"""The type and range of every key of params.yaml, and no value: one knob a line."""

from industnerf.schema.carving import SpaceCarvingSettings
from industnerf.schema.industnerf import (
    IndustnerfSettings,
    LevelSettings,
    ReliefSettings,
    SchoolSettings,
    SoftnessSettings,
    StartSettings,
    WarmUpSettings,
)
from industnerf.schema.learning import AugmentSettings, TrainingSettings
from industnerf.schema.methods import (
    AtlasNetSettings,
    CarveSettings,
    HullRgbSettings,
    HullSettings,
    MeanShapeSettings,
    MethodSettings,
    OccupancySettings,
    R2n2Settings,
    RetrievalSettings,
    SampleSettings,
    TsdfSettings,
)
from industnerf.schema.parts import CleanParams, PartsParams
from industnerf.schema.rules import require
from industnerf.schema.study import (
    EvaluateParams,
    Params,
    ReconstructParams,
    ReportParams,
    SplitParams,
    TrainParams,
)
from industnerf.schema.views import (
    CalibrationParams,
    JitterParams,
    LightParams,
    PhotoParams,
    SensorParams,
    ViewsParams,
)

__all__ = [
    "AtlasNetSettings",
    "AugmentSettings",
    "CalibrationParams",
    "CarveSettings",
    "CleanParams",
    "EvaluateParams",
    "HullRgbSettings",
    "HullSettings",
    "IndustnerfSettings",
    "JitterParams",
    "LevelSettings",
    "LightParams",
    "MeanShapeSettings",
    "MethodSettings",
    "OccupancySettings",
    "Params",
    "PartsParams",
    "PhotoParams",
    "R2n2Settings",
    "ReconstructParams",
    "ReliefSettings",
    "ReportParams",
    "RetrievalSettings",
    "SampleSettings",
    "SchoolSettings",
    "SensorParams",
    "SoftnessSettings",
    "SpaceCarvingSettings",
    "SplitParams",
    "StartSettings",
    "TrainParams",
    "TrainingSettings",
    "TsdfSettings",
    "ViewsParams",
    "WarmUpSettings",
    "require",
]
