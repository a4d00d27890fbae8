"""Loose faces beside a solid: what a drawing's notes, or a slip of the pen, leave in a file.

They hold no volume and hardly any area, but the bounding box goes around them, and a mesh of a
solid and a loose face is open: it has no volume at all.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.edges import build_edges
from industnerf.parts.repair.invalid_faces import has_three_corners, unique_first
from industnerf.parts.repair.mesh_ops import concatenate, format_share, select_faces, solid_of_faces
from industnerf.parts.validation.checks import double_area_normals, surface_components
from industnerf.schema import RepairParams

MAX_LOOSE_SHARE = 0.005  # of the area; a larger piece is a sheet that is meant
MIN_BORDER_SHARE = 0.2  # of a piece's edges; a screw that is all but closed has fewer
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
        f"loose faces beside the solid removed: {loose.sum()}, {format_share(share)} of the area"
    ]


def find_loose_faces(mesh: Mesh, settings: RepairParams) -> tuple[Bool[np.ndarray, "m"], float]:
    """The faces of open pieces below MAX_LOOSE_SHARE, and their share of the area.

    None if `small_component_area` is 0, if closed pieces have less than MIN_SOLID_SHARE of the
    area, or if the loose ones have more than `max_removed_area`.
    """
    proper = has_three_corners(mesh.faces)
    proper[proper] = unique_first(mesh.faces[proper])  # as a later step leaves them
    faces = mesh.faces[proper]
    piece, edges = surface_components(faces), build_edges(faces)
    is_border = edges.face_count == 1
    num_sides = np.bincount(piece, minlength=1) * 3
    num_border = np.bincount(piece, is_border[edges.edges_of_face].sum(axis=1))
    num_unsound = np.bincount(piece, (~edges.is_sound)[edges.edges_of_face].sum(axis=1))
    area = np.bincount(piece, np.linalg.norm(double_area_normals(mesh.vertices, faces), axis=1))
    share = area / max(area.sum(), np.finfo(float).tiny)
    # an edge within the piece is the side of two of its faces
    border_share = num_border / np.maximum((num_sides + num_border) / 2, 1)
    is_loose = (share < MAX_LOOSE_SHARE) & (border_share >= MIN_BORDER_SHARE)
    total = float(share[is_loose].sum())
    has_solid = share[num_unsound == 0].sum() >= MIN_SOLID_SHARE
    if not (settings.small_component_area and has_solid and total <= settings.max_removed_area):
        is_loose[:] = False
    loose = np.zeros(len(mesh.faces), bool)
    loose[proper] = is_loose[piece]
    return loose, total
