"""Loose faces beside a solid: what a drawing's notes, or a slip of the pen, leave in a file.

They hold no volume and hardly any area, but the bounding box goes around them, and a mesh of a
solid and a loose face is open: it has no volume at all.  They may lie so far off that the solid is
a point beside them, so they are sought at the scale of the solid.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.edges import build_edges
from industnerf.parts.repair.invalid_faces import has_three_corners, unique_first
from industnerf.parts.repair.mesh_ops import (
    Normalization,
    concatenate,
    fit_normalization,
    format_share,
    select_faces,
    solid_of_faces,
)
from industnerf.parts.repair.weld import weld
from industnerf.parts.validation.checks import double_area_normals, surface_components
from industnerf.schema import RepairParams

MAX_LOOSE_SHARE = 0.005  # of the area; a larger piece is a sheet that is meant
MIN_BORDER_SHARE = 0.2  # of a piece's edges; a screw that is all but closed has fewer
MIN_SOLID_SHARE = 0.5  # of the area that closed pieces have, for the others to be loose
MAX_CORE_SIZE = 0.5  # of the whole box; a larger core has the scale of the whole


@dataclass(frozen=True)
class LooseFaces:
    """Faces of open pieces below MAX_LOOSE_SHARE, beside closed ones."""

    mask: Bool[np.ndarray, "m"]
    num_pieces: int
    share: float  # of the area


def drop_loose_faces(
    solids: list[Mesh], settings: RepairParams
) -> tuple[list[Mesh], list[str], list[str]]:
    """`solids` (mm, finite) without their loose faces.

    None are sought if `small_component_area` is 0.  All stay if together they exceed
    `max_removed_area`.
    """
    if not settings.small_component_area:
        return solids, [], []
    scale = fit_normalization(solids)
    core = fit_normalization(_densest_faces(solids, settings.max_removed_area))
    if core.diagonal < MAX_CORE_SIZE * scale.diagonal:
        scale = fit_normalization(_without(solids, _find_at_scale(solids, core, settings).mask))
    loose = _find_at_scale(solids, scale, settings)
    if not loose.mask.any():
        return solids, [], []
    kept, share = _without(solids, loose.mask), format_share(loose.share)
    if loose.share <= settings.max_removed_area:
        message = f"loose faces beside the solid removed: {loose.mask.sum()}, {share} of the area"
        return kept, [message], []
    message = (
        f"loose sheets beside a closed solid left: {loose.num_pieces} with {share} of the area, "
        f"more than parts.repair.max_removed_area ({settings.max_removed_area:.2%})"
    )
    size, solid_size = (fit_normalization(meshes).diagonal for meshes in (solids, kept))
    if size > solid_size:
        message += (
            "; they set the size of the part: the diagonal of its bounding box is "
            f"{size:.4g} mm, {solid_size:.4g} mm without them"
        )
    return solids, [], [message]


def _densest_faces(solids: list[Mesh], left_out: float) -> list[Mesh]:
    """`solids` without the faces farthest from the median, which have `left_out` of the area."""
    whole = fit_normalization(solids).normalize(concatenate(solids))
    area = np.linalg.norm(double_area_normals(whole.vertices, whole.faces), axis=1)
    centers = whole.triangles.mean(axis=1)
    median = np.empty(3)
    for axis, positions in enumerate(centers.T):
        order = np.argsort(positions)
        cumulative = np.cumsum(area[order])
        median[axis] = positions[order[np.searchsorted(cumulative, cumulative[-1] / 2)]]
    order = np.argsort(np.linalg.norm(centers - median, axis=1), kind="stable")
    nearer = np.cumsum(area[order]) - area[order]
    is_far = np.zeros(len(area), bool)
    is_far[order] = nearer > (1 - left_out) * area.sum()
    return _without(solids, is_far)


def _without(solids: Sequence[Mesh], mask: Bool[np.ndarray, "m"]) -> list[Mesh]:
    """`solids` without the faces that `mask` marks, and without solids that are then empty."""
    owner = solid_of_faces(solids)
    kept_masks = [~mask[owner == i] for i in range(len(solids))]
    return [
        select_faces(solid, kept)
        for solid, kept in zip(solids, kept_masks, strict=True)
        if kept.any()
    ]


def _find_at_scale(
    solids: list[Mesh], normalization: Normalization, settings: RepairParams
) -> LooseFaces:
    """The loose faces of `solids`, which are welded as `normalization` has them."""
    return find_loose_faces(
        concatenate(weld([normalization.normalize(solid) for solid in solids], settings)[0])
    )


def find_loose_faces(mesh: Mesh) -> LooseFaces:
    """The loose faces of a welded `mesh`.

    None if closed pieces have less than MIN_SOLID_SHARE of the area.
    """
    loose = np.zeros(len(mesh.faces), bool)
    proper = has_three_corners(mesh.faces)
    if not proper.any():
        return LooseFaces(loose, 0, 0.0)
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
    if share[num_unsound == 0].sum() < MIN_SOLID_SHARE:
        is_loose[:] = False
    loose[proper] = is_loose[piece]
    return LooseFaces(loose, int(is_loose.sum()), float(share[is_loose].sum()))
