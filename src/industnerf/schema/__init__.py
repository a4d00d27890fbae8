"""The type and range of every key of params.yaml, and no value: one key a line."""

from industnerf.schema.carving import SpaceCarvingSettings
from industnerf.schema.industnerf import (
    BetaSchedule,
    IndustnerfDepthSettings,
    IndustnerfPlusSettings,
    IndustnerfSettings,
    IndustnerfSharedSettings,
    LevelSettings,
    PretrainingSettings,
    SdfInitSettings,
    SdfSettings,
    WarmUpSettings,
)
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
from industnerf.schema.params import (
    EvaluateParams,
    Params,
    ReconstructParams,
    ReportParams,
    SplitParams,
    TrainParams,
)
from industnerf.schema.parts import PartsParams, RepairParams
from industnerf.schema.training import AugmentSettings, TrainingSettings
from industnerf.schema.validators import require
from industnerf.schema.views import (
    CalibrationParams,
    JitterParams,
    LightParams,
    PhotorealisticParams,
    SensorParams,
    ViewsParams,
)

__all__ = [
    "AtlasNetSettings",
    "AugmentSettings",
    "BetaSchedule",
    "CalibrationParams",
    "CarveSettings",
    "EvaluateParams",
    "HullRgbSettings",
    "HullSettings",
    "IndustnerfDepthSettings",
    "IndustnerfPlusSettings",
    "IndustnerfSettings",
    "IndustnerfSharedSettings",
    "JitterParams",
    "LevelSettings",
    "LightParams",
    "MeanShapeSettings",
    "MethodSettings",
    "OccupancySettings",
    "Params",
    "PartsParams",
    "PhotorealisticParams",
    "PretrainingSettings",
    "R2n2Settings",
    "ReconstructParams",
    "RepairParams",
    "ReportParams",
    "RetrievalSettings",
    "SampleSettings",
    "SdfInitSettings",
    "SdfSettings",
    "SensorParams",
    "SpaceCarvingSettings",
    "SplitParams",
    "TrainParams",
    "TrainingSettings",
    "TsdfSettings",
    "ViewsParams",
    "WarmUpSettings",
    "require",
]
