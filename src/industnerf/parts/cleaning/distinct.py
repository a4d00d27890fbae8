"""Faces that are no triangle, and faces that are there twice."""

import numpy as np
from jaxtyping import Bool, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.cleaning.selection import kept
from industnerf.schema import CleanParams


def distinct(solids: list[Mesh], _: CleanParams) -> tuple[list[Mesh], list[str], list[str]]:
    """Faces of three different corners, each once whichever way round; the first of several stays.

    Corners are compared by index alone, so that slivers stay.
    """
    proper = [triangular(solid.faces) for solid in solids]
    solids = [kept(s, p) for s, p in zip(solids, proper, strict=True) if p.any()]
    once = [first_ones(solid.faces) for solid in solids]
    told = {
        "faces dropped that are welded to a line or a point: {}": proper,
        "repeated faces dropped: {}": once,
    }
    counts = {text: sum(int((~good).sum()) for good in masks) for text, masks in told.items()}
    said = [text.format(count) for text, count in counts.items() if count]
    return [kept(s, o) for s, o in zip(solids, once, strict=True)], said, []


def triangular(faces: Int[np.ndarray, "m 3"]) -> Bool[np.ndarray, "m"]:
    """Whether the three corners of each face differ."""
    a, b, c = faces.T
    return (a != b) & (b != c) & (c != a)


def first_ones(faces: Int[np.ndarray, "m 3"]) -> Bool[np.ndarray, "m"]:
    """Whether no face before it has the same three corners, in any order."""
    ordered = np.sort(faces, axis=1)
    order = np.lexsort(ordered.T)  # stable: the first of equals stays first
    ordered = ordered[order]
    first = np.ones(len(faces), bool)
    first[order[1:]] = (ordered[1:] != ordered[:-1]).any(axis=1)
    return first
