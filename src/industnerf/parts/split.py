"""The split, by hash: adding parts moves no other part."""

import hashlib

from industnerf.artifacts.part import Part
from industnerf.artifacts.split import Place
from industnerf.schema import SplitParams


def assign(parts: list[Part], settings: SplitParams) -> dict[str, Place]:
    """Place every part.

    A share of the embedded parts is `dev`; a file that the user brought never is, for nothing
    was tuned on it.  The others are `test`, their whole family in one of `folds` folds.
    """
    places = {}
    for part in parts:
        if part.origin == "embedded" and _share("dev", part.part_id) < settings.dev_share:
            places[part.part_id] = Place("dev", None)
        else:
            fold = int(_share("fold", part.family) * settings.folds)
            places[part.part_id] = Place("test", fold)
    return places


def _share(purpose: str, name: str) -> float:
    """A number in [0, 1) that depends on `purpose` and `name` alone."""
    digest = hashlib.sha256(f"{purpose}/{name}".encode()).digest()
    return int.from_bytes(digest[:8], "big") / 2**64
