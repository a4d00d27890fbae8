"""The type and range of every key of params.yaml, and no value: one knob a line."""

from industnerf.schema.industnerf import (
    IndustnerfSettings,
    LevelSettings,
    ReliefSettings,
    SoftnessSettings,
    WarmUpSettings,
)
from industnerf.schema.methods import HullRgbSettings, HullSettings, MethodSettings, SampleSettings
from industnerf.schema.parts import CleanParams, PartsParams
from industnerf.schema.rules import require
from industnerf.schema.study import (
    EvaluateParams,
    Params,
    ReconstructParams,
    ReportParams,
    SplitParams,
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
    "CalibrationParams",
    "CleanParams",
    "EvaluateParams",
    "HullRgbSettings",
    "HullSettings",
    "IndustnerfSettings",
    "JitterParams",
    "LevelSettings",
    "LightParams",
    "MethodSettings",
    "Params",
    "PartsParams",
    "PhotoParams",
    "ReconstructParams",
    "ReliefSettings",
    "ReportParams",
    "SampleSettings",
    "SensorParams",
    "SoftnessSettings",
    "SplitParams",
    "ViewsParams",
    "WarmUpSettings",
    "require",
]
