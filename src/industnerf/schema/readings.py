"""The readings of the paper: R1 to R16 of docs/readings.md, each the argument of one function."""

from dataclasses import dataclass
from typing import Literal

PoseReading = Literal["intended", "printed", "nerf", "identity"]
FrameReading = Literal["camera", "world", "pose"]
PoolReading = Literal["confident", "all", "mean_variance", "mean", "surest", "max"]
ActivationReading = Literal["distance", "cut_exp", "relu", "softplus"]
PlaceReading = Literal["jitter", "centre"]
TargetReading = Literal["sigma", "visible"]
WeightReading = Literal["inverse", "inverse_square", "tapered", "tent"]
ScaleReading = Literal["max", "unit", "contrast"]
TransmittanceReading = Literal["shared", "own"]
SignalReading = Literal["sources", "left_out"]
CloudReading = Literal["confident", "surface", "fused"]
EncoderReading = Literal["per_part", "shared", "frozen", "none"]
OpacityReading = Literal["without", "with"]
ReduceReading = Literal["max", "sum"]


@dataclass(frozen=True)
class Readings:
    """One choice for every ambiguity; R12 and R13 have no key: every way is scored."""

    pose: PoseReading  # R1
    frame: FrameReading  # R2
    views: PoolReading  # R3
    activation: ActivationReading  # R4
    place: PlaceReading  # R5
    target: TargetReading  # R6
    weights: WeightReading  # R7
    scale: ScaleReading  # R8
    transmittance: TransmittanceReading  # R9
    signal: SignalReading  # R10
    cloud: CloudReading  # R11
    encoder: EncoderReading  # R14
    opacity: OpacityReading  # R15
    samples: ReduceReading  # R16
