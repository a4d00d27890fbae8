"""Who does what: which of the source views speak and which judge, R10; what E is there for, R14."""

from dataclasses import dataclass
from typing import assert_never

from industnerf.schema.readings import EncoderReading, SignalReading


@dataclass(frozen=True)
class ViewRoles:
    """Of the source views, in their order."""

    telling: slice  # N is told of the points by these
    judging: slice  # and the error is taken over these


@dataclass(frozen=True)
class EncoderRole:
    """What becomes of E."""

    heard: bool  # N is told what E makes of the views
    learns: bool  # on the part's own images


def view_roles(reading: SignalReading) -> ViewRoles:
    """R10.  sources: all views do both.  left_out: every other one judges what the rest tell."""
    match reading:
        case "sources":
            return ViewRoles(slice(None), slice(None))
        case "left_out":
            return ViewRoles(slice(0, None, 2), slice(1, None, 2))
        case _:
            assert_never(reading)


def encoder_role(reading: EncoderReading) -> EncoderRole:
    """R14.  shared has learned before, frozen never did: here both stay as they are."""
    match reading:
        case "per_part":
            return EncoderRole(heard=True, learns=True)
        case "shared" | "frozen":
            return EncoderRole(heard=True, learns=False)
        case "none":
            return EncoderRole(heard=False, learns=False)
        case _:
            assert_never(reading)
