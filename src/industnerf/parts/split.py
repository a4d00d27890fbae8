"""The split, by hash: adding parts moves no other part."""

import hashlib
from typing import assert_never

from industnerf.artifacts.part import Part
from industnerf.artifacts.split import SplitAssignment
from industnerf.schema import SplitParams


def assign_splits(parts: list[Part], settings: SplitParams) -> dict[str, SplitAssignment]:
    """The split and fold of every part, by id.

    A share of the embedded parts is `dev`.  A user's file never is, because nothing was tuned on
    it.  Parts that are held out together share one of `folds` folds.
    """
    return {
        part.part_id: SplitAssignment(_split(part, settings), _fold(part, settings))
        for part in parts
    }


def is_dev(part_id: str, origin: str, settings: SplitParams) -> bool:
    """Whether a part may be tuned on: an embedded one, of the share of `settings`."""
    return origin == "embedded" and _hash_fraction("dev", part_id) < settings.dev_fraction


def _split(part: Part, settings: SplitParams) -> str:
    return "dev" if is_dev(part.part_id, part.origin, settings) else "test"


def _fold(part: Part, settings: SplitParams) -> int | None:
    match settings.hold_out:
        case "family":
            return int(_hash_fraction("fold", part.family) * settings.folds)
        case "part":
            return int(_hash_fraction("fold", part.part_id) * settings.folds)
        case "none":
            return None
        case _:
            assert_never(settings.hold_out)


def _hash_fraction(purpose: str, name: str) -> float:
    """A number in [0, 1) that depends on `purpose` and `name` alone."""
    digest = hashlib.sha256(f"{purpose}/{name}".encode()).digest()
    return int.from_bytes(digest[:8], "big") / 2**64
