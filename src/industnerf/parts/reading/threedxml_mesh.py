"""Surfaces of 3DXML: points, and faces as triangles, strips and fans."""

from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.parts.reading.content import Body, require_indices, unpainted
from industnerf.parts.reading.paint import linear

Paint = Float64[np.ndarray, "3"]


def representation(root: Any, materials: dict[str, Paint]) -> list[Body]:
    """The pieces of one shape; coarser copies of them for far views are passed over."""
    return [
        piece
        for node in root.iter("{*}Rep")
        if (places := node.find("{*}VertexBuffer/{*}Positions")) is not None
        if (piece := _piece(node, places.text or "", materials)) is not None
    ]


def _piece(node: Any, places: str, materials: dict[str, Paint]) -> Body | None:
    vertices = np.array(places.replace(",", " ").split(), np.float64).reshape(-1, 3)
    own = _colour(node, materials, unpainted(1)[0])
    corners, albedo = [], []
    for group in node.iterfind("{*}Faces"):
        common = _colour(group, materials, own)
        for face in group.iterfind("{*}Face"):
            triangles = _triangles(face)
            corners.append(triangles)
            paint = _colour(face, materials, common)
            albedo.append(np.broadcast_to(paint, (len(triangles), 3)))
    if not corners:
        return None
    faces = np.concatenate(corners)
    require_indices(faces, len(vertices), "3DXML")
    return Body("", vertices, faces, np.concatenate(albedo))


def _triangles(face: Any) -> Int64[np.ndarray, "m 3"]:
    found = [np.array(face.get("triangles", "").split(), np.int64).reshape(-1, 3)]
    for text in face.get("strips", "").split(","):
        order = np.array(text.split(), np.int64)
        i = np.arange(max(len(order) - 2, 0))
        odd = i % 2  # every other triangle of a strip runs the other way
        found.append(np.stack([order[i], order[i + 1 + odd], order[i + 2 - odd]], axis=1))
    for text in face.get("fans", "").split(","):
        order = np.array(text.split(), np.int64)
        i = np.arange(max(len(order) - 2, 0))
        found.append(np.stack([order[0 * i], order[i + 1], order[i + 2]], axis=1))
    return np.concatenate(found)


def _colour(node: Any, materials: dict[str, Paint], otherwise: Paint) -> Paint:
    """The colour or the material at `node`; `otherwise` if it states none."""
    colour = node.find("{*}SurfaceAttributes/{*}Color")
    if colour is not None:
        channels = [float(colour.get(name, 1)) for name in ("red", "green", "blue")]
        return linear(np.array(channels))
    material = node.find("{*}SurfaceAttributes/{*}MaterialApplication/{*}MaterialId")
    if material is not None:
        return materials.get(material.get("id", "").rpartition("#")[2], otherwise)
    return otherwise
