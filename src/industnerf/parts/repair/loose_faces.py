"""Loose faces beside a solid: what a drawing's notes, or a slip of the pen, leave in a file.

They hold no volume and hardly any area, but the bounding box goes around them, and a mesh of a
solid and a loose face is open: it has no volume at all.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.edges import build_edges
from industnerf.parts.repair.mesh_ops import concatenate, select_faces, solid_of_faces
from industnerf.parts.validation.checks import double_area_normals, surface_components
from industnerf.schema import RepairParams

MAX_LOOSE_SHARE = 0.005  # of the area; a larger piece is a sheet that is meant
MIN_SOLID_SHARE = 0.5  # of the area that closed pieces have, for the others to be loose


def drop_loose_faces(
    solids: Sequence[Mesh], welded: Sequence[Mesh], settings: RepairParams
) -> tuple[list[Mesh], list[str]]:
    """`solids` without their loose faces, and a sentence on these, if there are any.

    `welded` are the same faces, welded.
    """
    loose, share = find_loose_faces(concatenate(welded), settings)
    if not loose.any():
        return list(solids), []
    owner = solid_of_faces(solids)
    kept_masks = [~loose[owner == i] for i in range(len(solids))]
    kept = [
        select_faces(solid, mask)
        for solid, mask in zip(solids, kept_masks, strict=True)
        if mask.any()
    ]
    return kept, [
        f"loose faces beside the solid removed: {loose.sum()}, with {share:.1g} of the area"
    ]


def find_loose_faces(mesh: Mesh, settings: RepairParams) -> tuple[Bool[np.ndarray, "m"], float]:
    """The faces of open pieces below MAX_LOOSE_SHARE, and their share of the area.

    None if `small_component_area` is 0, if closed pieces have less than MIN_SOLID_SHARE of the
    area, or if the loose ones have more than `max_removed_area`.
    """
    piece = surface_components(mesh.faces)
    edges = build_edges(mesh.faces)
    is_open = np.zeros(piece.max() + 1, bool)
    is_open[piece[(~edges.is_sound)[edges.edges_of_face].any(axis=1)]] = True
    area = np.bincount(
        piece, np.linalg.norm(double_area_normals(mesh.vertices, mesh.faces), axis=1)
    )
    share = area / max(area.sum(), np.finfo(float).tiny)
    is_loose = is_open & (share < MAX_LOOSE_SHARE)
    total = float(share[is_loose].sum())
    has_solid = share[~is_open].sum() >= MIN_SOLID_SHARE
    if not (settings.small_component_area and has_solid and total <= settings.max_removed_area):
        is_loose[:] = False
    return is_loose[piece], total
