"""Faces that are nowhere: a corner is infinite or not a number."""

import numpy as np

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.parts.cleaning.selection import compacted, kept


def finite(solids: list[Mesh]) -> tuple[list[Mesh], list[str]]:
    """`solids` without faces of non-finite corners, and without solids that are then empty.

    Raises BadPart if no face is left.
    """
    good = [np.isfinite(s.vertices).all(axis=1)[s.faces].all(axis=1) for s in solids]
    left = [compacted(kept(s, g)) for s, g in zip(solids, good, strict=True) if g.any()]
    total, bad = sum(map(len, good)), sum(int((~g).sum()) for g in good)
    if not left:
        raise BadPart(f"none of its {total} faces has three finite corners")
    return left, [f"faces dropped for a non-finite corner: {bad} of {total}"] if bad else []
