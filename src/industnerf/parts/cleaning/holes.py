"""Small flat holes, closed by the polygon of their border.  It invents surface: only if asked."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.checks import area_mm2
from industnerf.parts.cleaning.edges import components, edges_of
from industnerf.schema import CleanParams

LARGEST = 0.1  # diagonals across; what is larger is more likely the border of a sheet
FLAT = 0.1  # of its own size: the furthest that a border may leave its mean plane


def fill_holes(
    solids: list[Mesh], settings: CleanParams
) -> tuple[list[Mesh], list[str], list[str]]:
    """`solids` with every simple hole closed that is small and nearly flat."""
    if not settings.fill_holes:
        return solids, [], []
    filled, counts, left, areas = zip(*(_filled(solid) for solid in solids), strict=True)
    share = sum(areas) / sum(area_mm2(solid.vertices, solid.faces) for solid in filled)
    told = f"holes closed with flat lids: {sum(counts)}, {share:.2%} of the area"
    remains = (
        f"open borders left: {sum(left)}, which are wider than {LARGEST:g} of the diagonal, not "
        "flat, or branched"
    )
    return list(filled), [told] if sum(counts) else [], [remains] if sum(left) else []


def _filled(solid: Mesh) -> tuple[Mesh, int, int, float]:
    """The mesh, the holes closed and left, and the area added."""
    lids: list[np.ndarray] = []
    finishes: list[np.ndarray] = []
    left = 0
    for loop, finish in borders(solid):
        lid = _lid(solid.vertices[loop]) if len(loop) >= 3 else None
        if lid is None:
            left += 1
            continue
        lids.append(loop[lid].astype(np.int32))
        finishes.append(np.full(len(lid), finish, np.uint8))
    if not lids:
        return solid, 0, left, 0.0
    mesh = Mesh(
        solid.vertices,
        np.concatenate([solid.faces, *lids]),
        np.concatenate([solid.finish, *finishes]),
    )
    return mesh, len(lids), left, area_mm2(solid.vertices, np.concatenate(lids))


def borders(solid: Mesh) -> Iterator[tuple[Int[np.ndarray, "k"], np.uint8]]:
    """Each connected border as vertices in the order of its lid, and the finish beside it.

    A border that branches, or ends, comes out as no vertices.
    """
    edges = edges_of(solid.faces)
    face, side = np.nonzero((edges.count == 1)[edges.of_face])
    start, end = solid.faces[face, side], solid.faces[face, (side + 1) % 3]
    label = components(np.stack([start, end], axis=1), len(solid.vertices))[start]
    order = np.argsort(label, kind="stable")
    for own in np.split(order, np.flatnonzero(np.diff(label[order])) + 1):
        if len(own):
            yield _loop(start[own], end[own]), solid.finish[face[own[0]]]


def _loop(start: Int[np.ndarray, "k"], end: Int[np.ndarray, "k"]) -> Int[np.ndarray, "l"]:
    """The vertices of connected half-edges, backwards, or none if they are not one ring."""
    ring = np.unique(start)
    if len(ring) < len(start) or not np.array_equal(ring, np.unique(end)):
        return start[:0]
    before = dict(zip(end.tolist(), start.tolist(), strict=True))
    loop = [int(ring[0])]
    while len(loop) < len(start):
        loop.append(before[loop[-1]])
    return np.array(loop)


def _lid(border: Float[np.ndarray, "k 3"]) -> Int[np.ndarray, "t 3"] | None:
    """Triangles that close `border` and run along it, or None if it is large or not flat."""
    import manifold3d

    centred = border - border.mean(axis=0)
    size = float(np.linalg.norm(np.ptp(border, axis=0)))
    normal = np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0)  # Newell's
    if size > LARGEST or not np.linalg.norm(normal) > 0:
        return None
    normal /= np.linalg.norm(normal)
    if np.abs(centred @ normal).max() > FLAT * size:
        return None
    u, v = np.linalg.svd(normal[None])[2][1:]
    flat = np.stack([centred @ u, centred @ v * np.dot(np.cross(u, v), normal)], axis=1)
    return np.asarray(manifold3d.triangulate([flat]))
