"""Faces with a non-finite corner, faces of fewer than three corners, and repeated faces."""

import numpy as np
from jaxtyping import Bool, Int

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.parts.repair.mesh_ops import drop_unused_vertices, select_faces
from industnerf.schema import RepairParams


def deduplicate_faces(
    solids: list[Mesh], _: RepairParams
) -> tuple[list[Mesh], list[str], list[str]]:
    """Faces of three different corners, each once whichever way round; the first of several stays.

    Corners are compared by index alone, so that slivers stay.
    """
    proper_masks = [has_three_corners(solid.faces) for solid in solids]
    solids = [select_faces(s, p) for s, p in zip(solids, proper_masks, strict=True) if p.any()]
    first_masks = [unique_first(solid.faces) for solid in solids]
    masks_of_message = {
        "faces dropped that are welded to a line or a point: {}": proper_masks,
        "repeated faces dropped: {}": first_masks,
    }
    counts = {
        text: sum(int((~mask).sum()) for mask in message_masks)
        for text, message_masks in masks_of_message.items()
    }
    messages = [text.format(count) for text, count in counts.items() if count]
    return (
        [select_faces(s, first) for s, first in zip(solids, first_masks, strict=True)],
        messages,
        [],
    )


def has_three_corners(faces: Int[np.ndarray, "m 3"]) -> Bool[np.ndarray, "m"]:
    """Whether the three corners of each face differ."""
    a, b, c = faces.T
    return (a != b) & (b != c) & (c != a)


def unique_first(faces: Int[np.ndarray, "m 3"]) -> Bool[np.ndarray, "m"]:
    """Whether no face before it has the same three corners, in any order."""
    ordered = np.sort(faces, axis=1)
    order = np.lexsort(ordered.T)  # stable: the first of equals stays first
    ordered = ordered[order]
    is_first = np.ones(len(faces), bool)
    is_first[order[1:]] = (ordered[1:] != ordered[:-1]).any(axis=1)
    return is_first


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
