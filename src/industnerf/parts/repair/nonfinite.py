"""Faces that are nowhere: a corner is infinite or not a number."""

import numpy as np

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.parts.repair.mesh_ops import drop_unused_vertices, select_faces


def drop_nonfinite(solids: list[Mesh]) -> tuple[list[Mesh], list[str]]:
    """`solids` without faces of non-finite corners, and without solids that are then empty.

    Raises BadPart if no face is left.
    """
    masks = [np.isfinite(s.vertices).all(axis=1)[s.faces].all(axis=1) for s in solids]
    finite_solids = [
        drop_unused_vertices(select_faces(s, mask))
        for s, mask in zip(solids, masks, strict=True)
        if mask.any()
    ]
    total, num_bad = sum(map(len, masks)), sum(int((~mask).sum()) for mask in masks)
    if not finite_solids:
        raise BadPart(f"none of its {total} faces has three finite corners")
    return finite_solids, [
        f"faces dropped for a non-finite corner: {num_bad} of {total}"
    ] if num_bad else []
