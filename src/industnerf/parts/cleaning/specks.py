"""Loose pieces so small that they are dirt, not part of the part."""

import numpy as np
from jaxtyping import Float, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.checks import doubled_normals
from industnerf.parts.cleaning.edges import pieces_of
from industnerf.parts.cleaning.selection import joined, kept, solid_of_faces
from industnerf.schema import CleanParams


def drop_specks(
    solids: list[Mesh], settings: CleanParams
) -> tuple[list[Mesh], list[str], list[str]]:
    """`solids` without pieces below `speck_area` of the area and `speck_size` diagonals.

    A solid that the file holds by itself is no speck, however small: it is a screw or a washer.
    So the largest piece of each solid stays.  All stay if the specks exceed `specks_at_most`.
    """
    whole = joined(solids)
    piece, solid = pieces_of(whole.faces), solid_of_faces(solids)
    area = np.bincount(
        piece, np.linalg.norm(doubled_normals(whole.vertices, whole.faces), axis=1) / 2
    )
    share = area / max(area.sum(), np.finfo(float).tiny)
    speck = (share < settings.speck_area) & (_sizes(whole, piece) < settings.speck_size)
    speck[_largest(area, piece, solid)] = False
    count, total = int(speck.sum()), float(share[speck].sum())
    said = f"{count} loose pieces with {total:.2%} of the area"
    if not count:
        return solids, [], []
    if total > settings.specks_at_most:
        limit = f"parts.clean.specks_at_most ({settings.specks_at_most:.2%})"
        return solids, [], [f"specks left: {said}, more than {limit}"]
    stays = ~speck[piece]
    left = [kept(s, stays[solid == i]) for i, s in enumerate(solids)]
    return left, [f"specks dropped: {said}"], []


def _sizes(mesh: Mesh, piece: Int[np.ndarray, "m"]) -> Float[np.ndarray, "pieces"]:
    """Diagonal of the bounding box of each piece."""
    order = np.argsort(piece, kind="stable")
    start = np.flatnonzero(np.diff(piece[order], prepend=-1))
    corners = mesh.triangles[order]
    low = np.minimum.reduceat(corners.min(axis=1), start)
    high = np.maximum.reduceat(corners.max(axis=1), start)
    return np.linalg.norm(high - low, axis=1)


def _largest(
    area: Float[np.ndarray, "pieces"], piece: Int[np.ndarray, "m"], solid: Int[np.ndarray, "m"]
) -> Int[np.ndarray, "solids"]:
    """The piece of each solid that has the most area."""
    owner = np.empty(len(area), np.int64)
    owner[piece] = solid
    order = np.lexsort((area, owner))
    return order[np.flatnonzero(np.diff(owner[order], append=-1))]
