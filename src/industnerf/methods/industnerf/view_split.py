"""Who does what: which of the source views speak and which judge, R10; what E is there for, R14."""

from dataclasses import dataclass
from typing import assert_never

from industnerf.schema.readings import EncoderReading, TargetViewsReading


@dataclass(frozen=True)
class SourceTargetSplit:
    """Of the source views, in their order."""

    source: slice  # N is told of the points by these
    target: slice  # and the error is taken over these


@dataclass(frozen=True)
class EncoderMode:
    """What becomes of E."""

    enabled: bool  # N is told what E makes of the views
    trainable: bool  # on the part's own images


def source_target_split(reading: TargetViewsReading) -> SourceTargetSplit:
    """R10.  sources: all views do both.  left_out: every other one judges what the rest tell."""
    match reading:
        case "same_as_source":
            return SourceTargetSplit(slice(None), slice(None))
        case "disjoint":
            return SourceTargetSplit(slice(0, None, 2), slice(1, None, 2))
        case _:
            assert_never(reading)


def encoder_mode(reading: EncoderReading) -> EncoderMode:
    """R14.  shared has learned before, frozen never did: here both stay as they are."""
    match reading:
        case "per_part":
            return EncoderMode(enabled=True, trainable=True)
        case "pretrained" | "frozen":
            return EncoderMode(enabled=True, trainable=False)
        case "none":
            return EncoderMode(enabled=False, trainable=False)
        case _:
            assert_never(reading)
