"""One primitive of a glTF mesh: its triangles and their albedo."""

from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.errors import BadPart
from industnerf.parts.io.readers import texture
from industnerf.parts.io.readers.gltf_buffers import Buffers
from industnerf.parts.io.readers.mesh_content import (
    MeshBody,
    require_valid_indices,
    unstated_albedo,
)

TRIANGLES, STRIP, FAN = 4, 5, 6


def read_primitive(
    node: dict[str, Any], tree: dict[str, Any], buffers: Buffers, name: str, warnings: list[str]
) -> MeshBody | None:
    """The body of `part`; None if it is points or lines, or empty."""
    mode = node.get("mode", TRIANGLES)
    if mode not in (TRIANGLES, STRIP, FAN):
        warnings.append("points and lines left out")
        return None
    vertices = (
        buffers.read_accessor(node["attributes"]["POSITION"]).astype(np.float64).reshape(-1, 3)
    )
    indices = np.arange(len(vertices))
    if "indices" in node:
        indices = buffers.read_accessor(node["indices"]).ravel().astype(np.int64)
    faces = _faces(indices, mode)
    require_valid_indices(faces, len(vertices), f"glTF: mesh {name!r}")
    if not len(faces):
        return None
    return MeshBody(name, vertices, faces, _albedo(node, tree, buffers, faces, warnings))


def _faces(indices: np.ndarray, mode: int) -> Int64[np.ndarray, "m 3"]:
    if mode == TRIANGLES:
        return indices[: len(indices) // 3 * 3].reshape(-1, 3).astype(np.int64)
    count = max(len(indices) - 2, 0)
    i = np.arange(count)
    if mode == FAN:
        return np.stack([indices[np.zeros(count, int)], indices[i + 1], indices[i + 2]], axis=1)
    odd = i % 2  # every other triangle of a strip runs the other way
    return np.stack([indices[i], indices[i + 1 + odd], indices[i + 2 - odd]], axis=1).reshape(-1, 3)


def _albedo(
    node: dict[str, Any],
    tree: dict[str, Any],
    buffers: Buffers,
    faces: Int64[np.ndarray, "m 3"],
    warnings: list[str],
) -> Float64[np.ndarray, "m 3"]:
    """Factor x picture x vertex color; factors and vertex colors are linear by the standard."""
    material = tree["materials"][node["material"]] if "material" in node else {}
    pbr = material.get("pbrMetallicRoughness", {})
    is_stated, albedo = "baseColorFactor" in pbr, np.ones((len(faces), 3))
    albedo *= np.array(pbr.get("baseColorFactor", [1, 1, 1])[:3], np.float64)
    if "COLOR_0" in node["attributes"]:
        albedo *= buffers.read_accessor(node["attributes"]["COLOR_0"])[faces].mean(axis=1)[:, :3]
        is_stated = True
    if "baseColorTexture" in pbr:
        texture_albedo = _texture_albedo(node, tree, buffers, pbr["baseColorTexture"], faces)
        warnings.append(
            texture.REDUCED_WARNING if texture_albedo is not None else texture.UNREADABLE_WARNING
        )
        if texture_albedo is not None:
            albedo, is_stated = albedo * texture_albedo, True
    return albedo if is_stated else unstated_albedo(len(faces))


def _texture_albedo(
    node: dict[str, Any],
    tree: dict[str, Any],
    buffers: Buffers,
    texture_info: dict[str, Any],
    faces: Int64[np.ndarray, "m 3"],
) -> Float64[np.ndarray, "m 3"] | None:
    uv = node["attributes"].get(f"TEXCOORD_{texture_info.get('texCoord', 0)}")
    source = tree["textures"][texture_info["index"]].get("source")
    if uv is None or source is None:
        return None
    image = tree["images"][source]
    is_embedded = "bufferView" in image
    try:
        data = buffers.read_view(image["bufferView"]) if is_embedded else buffers.load(image["uri"])
    except BadPart:  # a picture that is not there leaves the shape as it is
        return None
    corners = buffers.read_accessor(uv).astype(np.float64)[faces]
    return texture.sample_texture(data, corners * (1, -1) + (0, 1))  # glTF counts v downwards
