"""Surfaces of 3DXML: points, and faces as triangles, strips and fans."""

from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.parts.io.readers.colors import srgb_to_linear
from industnerf.parts.io.readers.mesh_content import (
    MeshBody,
    require_valid_indices,
    unstated_albedo,
)

Albedo = Float64[np.ndarray, "3"]


def read_representation(root: Any, materials: dict[str, Albedo]) -> list[MeshBody]:
    """The pieces of one shape; coarser copies of them for far views are passed over."""
    return [
        piece
        for node in root.iter("{*}Rep")
        if (positions := node.find("{*}VertexBuffer/{*}Positions")) is not None
        if (piece := _piece(node, positions.text or "", materials)) is not None
    ]


def _piece(node: Any, positions: str, materials: dict[str, Albedo]) -> MeshBody | None:
    vertices = np.array(positions.replace(",", " ").split(), np.float64).reshape(-1, 3)
    piece_albedo = _find_albedo(node, materials, unstated_albedo(1)[0])
    corners, albedo = [], []
    for group in node.iterfind("{*}Faces"):
        group_albedo = _find_albedo(group, materials, piece_albedo)
        for face in group.iterfind("{*}Face"):
            triangles = _triangles(face)
            corners.append(triangles)
            face_albedo = _find_albedo(face, materials, group_albedo)
            albedo.append(np.broadcast_to(face_albedo, (len(triangles), 3)))
    if not corners:
        return None
    faces = np.concatenate(corners)
    require_valid_indices(faces, len(vertices), "3DXML")
    return MeshBody("", vertices, faces, np.concatenate(albedo))


def _triangles(face: Any) -> Int64[np.ndarray, "m 3"]:
    groups = [np.array(face.get("triangles", "").split(), np.int64).reshape(-1, 3)]
    for text in face.get("strips", "").split(","):
        order = np.array(text.split(), np.int64)
        i = np.arange(max(len(order) - 2, 0))
        odd = i % 2  # every other triangle of a strip runs the other way
        groups.append(np.stack([order[i], order[i + 1 + odd], order[i + 2 - odd]], axis=1))
    for text in face.get("fans", "").split(","):
        order = np.array(text.split(), np.int64)
        i = np.arange(max(len(order) - 2, 0))
        groups.append(np.stack([order[0 * i], order[i + 1], order[i + 2]], axis=1))
    return np.concatenate(groups)


def _find_albedo(node: Any, materials: dict[str, Albedo], default: Albedo) -> Albedo:
    """The color or the material at `node`; `otherwise` if it states none."""
    color = node.find("{*}SurfaceAttributes/{*}Color")
    if color is not None:
        channels = [float(color.get(name, 1)) for name in ("red", "green", "blue")]
        return srgb_to_linear(np.array(channels))
    material = node.find("{*}SurfaceAttributes/{*}MaterialApplication/{*}MaterialId")
    if material is not None:
        return materials.get(material.get("id", "").rpartition("#")[2], default)
    return default
