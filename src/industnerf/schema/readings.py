"""Readings R1 to R16 (docs/reference/readings.md), each the argument of one function."""

from dataclasses import dataclass, field, fields
from typing import Literal

PositionEncodingReading = Literal["intended", "printed", "nerf", "identity"]
EncodingFrameReading = Literal["camera", "world", "camera_center"]
ViewPoolingReading = Literal[
    "confidence_weighted", "all", "mean_variance", "mean", "argmax_confidence", "max"
]
ActivationReading = Literal["sdf", "truncated_exp", "relu", "softplus"]
SamplePositionReading = Literal["jitter", "center"]
SamplingDensityReading = Literal["density", "visible_density"]
InterpolationReading = Literal["inverse", "inverse_square", "modified_shepard", "trilinear"]
ColorScaleReading = Literal["max", "unit", "contrast"]
TransmittanceReading = Literal["shared", "own"]
TargetViewsReading = Literal["same_as_source", "disjoint"]
ExtractionReading = Literal["confident_points", "surface_points", "tsdf_fusion"]
EncoderReading = Literal["per_part", "pretrained", "frozen", "none"]
OpacityReading = Literal["without", "with"]
SampleReductionReading = Literal["max", "sum"]


@dataclass(frozen=True)
class Readings:
    """One choice for every ambiguity; R12 and R13 have no key: every way is scored."""

    position_encoding: PositionEncodingReading = field(metadata={"number": "R1"})
    encoding_frame: EncodingFrameReading = field(metadata={"number": "R2"})
    view_pooling: ViewPoolingReading = field(metadata={"number": "R3"})
    density_activation: ActivationReading = field(metadata={"number": "R4"})
    sample_position: SamplePositionReading = field(metadata={"number": "R5"})
    sampling_density: SamplingDensityReading = field(metadata={"number": "R6"})
    interpolation: InterpolationReading = field(metadata={"number": "R7"})
    color_scale: ColorScaleReading = field(metadata={"number": "R8"})
    transmittance: TransmittanceReading = field(metadata={"number": "R9"})
    target_views: TargetViewsReading = field(metadata={"number": "R10"})
    extraction: ExtractionReading = field(metadata={"number": "R11"})
    encoder: EncoderReading = field(metadata={"number": "R14"})
    opacity: OpacityReading = field(metadata={"number": "R15"})
    sample_reduction: SampleReductionReading = field(metadata={"number": "R16"})


READING_IDS: dict[str, str] = {each.name: each.metadata["number"] for each in fields(Readings)}
