"""Loose pieces so small that they do not belong to the part."""

import numpy as np
from jaxtyping import Float, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.mesh_ops import (
    concatenate,
    format_share,
    select_faces,
    solid_of_faces,
)
from industnerf.parts.validation.checks import double_area_normals, surface_components
from industnerf.schema import RepairParams


def drop_small_components(
    solids: list[Mesh], settings: RepairParams
) -> tuple[list[Mesh], list[str], list[str]]:
    """`solids` without pieces below `small_component_area` and `small_component_size`.

    The area is a share of the whole, the size is in diagonals.  A solid that the file holds by
    itself stays, however small: it is a screw or a washer.  So the largest piece of each solid
    stays.  All stay if together they exceed `max_removed_area`.
    """
    whole = concatenate(solids)
    component, solid = surface_components(whole.faces), solid_of_faces(solids)
    area = np.bincount(
        component, np.linalg.norm(double_area_normals(whole.vertices, whole.faces), axis=1) / 2
    )
    share = area / max(area.sum(), np.finfo(float).tiny)
    is_small = (share < settings.small_component_area) & (
        _component_sizes(whole, component) < settings.small_component_size
    )
    is_small[_largest_components(area, component, solid)] = False
    count, total = int(is_small.sum()), float(share[is_small].sum())
    message = f"{count} loose pieces with {format_share(total)} of the area"
    if not count:
        return solids, [], []
    if total > settings.max_removed_area:
        limit = f"parts.repair.max_removed_area ({settings.max_removed_area:.2%})"
        return solids, [], [f"small components left: {message}, more than {limit}"]
    is_kept = ~is_small[component]
    kept_solids = [select_faces(s, is_kept[solid == i]) for i, s in enumerate(solids)]
    return kept_solids, [f"small components removed: {message}"], []


def _component_sizes(mesh: Mesh, component: Int[np.ndarray, "m"]) -> Float[np.ndarray, "pieces"]:
    """Diagonal of the bounding box of each piece."""
    order = np.argsort(component, kind="stable")
    starts = np.flatnonzero(np.diff(component[order], prepend=-1))
    corners = mesh.triangles[order]
    low = np.minimum.reduceat(corners.min(axis=1), starts)
    high = np.maximum.reduceat(corners.max(axis=1), starts)
    return np.linalg.norm(high - low, axis=1)


def _largest_components(
    area: Float[np.ndarray, "pieces"], component: Int[np.ndarray, "m"], solid: Int[np.ndarray, "m"]
) -> Int[np.ndarray, "solids"]:
    """The piece of each solid that has the most area."""
    owner = np.empty(len(area), np.int64)
    owner[component] = solid
    order = np.lexsort((area, owner))
    return order[np.flatnonzero(np.diff(owner[order], append=-1))]
