"""The readings of the paper: R1 to R16 of docs/readings.md, each the argument of one function."""

from dataclasses import dataclass, field, fields
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

    pose: PoseReading = field(metadata={"number": "R1"})
    frame: FrameReading = field(metadata={"number": "R2"})
    views: PoolReading = field(metadata={"number": "R3"})
    activation: ActivationReading = field(metadata={"number": "R4"})
    place: PlaceReading = field(metadata={"number": "R5"})
    target: TargetReading = field(metadata={"number": "R6"})
    weights: WeightReading = field(metadata={"number": "R7"})
    scale: ScaleReading = field(metadata={"number": "R8"})
    transmittance: TransmittanceReading = field(metadata={"number": "R9"})
    signal: SignalReading = field(metadata={"number": "R10"})
    cloud: CloudReading = field(metadata={"number": "R11"})
    encoder: EncoderReading = field(metadata={"number": "R14"})
    opacity: OpacityReading = field(metadata={"number": "R15"})
    samples: ReduceReading = field(metadata={"number": "R16"})


NUMBERS: dict[str, str] = {each.name: each.metadata["number"] for each in fields(Readings)}
