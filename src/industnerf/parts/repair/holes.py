"""Small flat holes, closed by the polygon of their border.  It invents surface: only if asked."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.edges import build_edges, component_labels
from industnerf.parts.validation.checks import area_mm2
from industnerf.schema import RepairParams

MAX_HOLE_SIZE = 0.1  # diagonals across; what is larger is more likely the border of a sheet
MAX_HOLE_DEPTH = 0.1  # of its own size: the furthest that a border may leave its mean plane


def fill_holes(
    solids: list[Mesh], settings: RepairParams
) -> tuple[list[Mesh], list[str], list[str]]:
    """`solids` with every simple hole closed that is small and nearly flat."""
    if not settings.fill_holes:
        return solids, [], []
    filled, counts, num_left, areas = zip(*(_fill_solid(solid) for solid in solids), strict=True)
    share = sum(areas) / sum(area_mm2(solid.vertices, solid.faces) for solid in filled)
    message = f"holes closed with flat lids: {sum(counts)}, {share:.2%} of the area"
    warning = (
        f"open borders left: {sum(num_left)}, which are wider than {MAX_HOLE_SIZE:g} of the "
        "diagonal, not flat, or branched"
    )
    return list(filled), [message] if sum(counts) else [], [warning] if sum(num_left) else []


def _fill_solid(solid: Mesh) -> tuple[Mesh, int, int, float]:
    """The mesh, the holes closed and left, and the area added."""
    lids: list[np.ndarray] = []
    finishes: list[np.ndarray] = []
    num_left = 0
    for loop, finish in border_loops(solid):
        lid = _triangulate_hole(solid.vertices[loop]) if len(loop) >= 3 else None
        if lid is None:
            num_left += 1
            continue
        lids.append(loop[lid].astype(np.int32))
        finishes.append(np.full(len(lid), finish, np.uint8))
    if not lids:
        return solid, 0, num_left, 0.0
    mesh = Mesh(
        solid.vertices,
        np.concatenate([solid.faces, *lids]),
        np.concatenate([solid.finish, *finishes]),
    )
    return mesh, len(lids), num_left, area_mm2(solid.vertices, np.concatenate(lids))


def border_loops(solid: Mesh) -> Iterator[tuple[Int[np.ndarray, "k"], np.uint8]]:
    """Each connected border as vertices in the order of its lid, and the finish beside it.

    A border that branches, or ends, comes out as no vertices.
    """
    edges = build_edges(solid.faces)
    face, side = np.nonzero((edges.face_count == 1)[edges.edges_of_face])
    start, end = solid.faces[face, side], solid.faces[face, (side + 1) % 3]
    label = component_labels(np.stack([start, end], axis=1), len(solid.vertices))[start]
    order = np.argsort(label, kind="stable")
    for members in np.split(order, np.flatnonzero(np.diff(label[order])) + 1):
        if len(members):
            yield _loop(start[members], end[members]), solid.finish[face[members[0]]]


def _loop(start: Int[np.ndarray, "k"], end: Int[np.ndarray, "k"]) -> Int[np.ndarray, "l"]:
    """The vertices of connected half-edges, backwards, or none if they are not one ring."""
    ring = np.unique(start)
    if len(ring) < len(start) or not np.array_equal(ring, np.unique(end)):
        return start[:0]
    previous = dict(zip(end.tolist(), start.tolist(), strict=True))
    loop = [int(ring[0])]
    while len(loop) < len(start):
        loop.append(previous[loop[-1]])
    return np.array(loop)


def _triangulate_hole(border: Float[np.ndarray, "k 3"]) -> Int[np.ndarray, "t 3"] | None:
    """Triangles that close `border` and run along it, or None if it is large or not flat."""
    import manifold3d

    centered = border - border.mean(axis=0)
    size = float(np.linalg.norm(np.ptp(border, axis=0)))
    normal = np.cross(centered, np.roll(centered, -1, axis=0)).sum(axis=0)  # Newell's
    if size > MAX_HOLE_SIZE or not np.linalg.norm(normal) > 0:
        return None
    normal /= np.linalg.norm(normal)
    if np.abs(centered @ normal).max() > MAX_HOLE_DEPTH * size:
        return None
    u, v = np.linalg.svd(normal[None])[2][1:]
    flattened = np.stack([centered @ u, centered @ v * np.dot(np.cross(u, v), normal)], axis=1)
    return np.asarray(manifold3d.triangulate([flattened]))
