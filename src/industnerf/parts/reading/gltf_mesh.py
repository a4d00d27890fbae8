"""One primitive of a glTF mesh: its triangles and their albedo."""

from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.errors import BadPart
from industnerf.parts.reading import texture
from industnerf.parts.reading.content import Body, require_indices, unpainted
from industnerf.parts.reading.gltf_buffers import Buffers

TRIANGLES, STRIP, FAN = 4, 5, 6


def primitive(
    part: dict[str, Any], tree: dict[str, Any], buffers: Buffers, name: str, remarks: list[str]
) -> Body | None:
    """The body of `part`; None if it is points or lines, or empty."""
    mode = part.get("mode", TRIANGLES)
    if mode not in (TRIANGLES, STRIP, FAN):
        remarks.append("points and lines left out")
        return None
    vertices = buffers.numbers(part["attributes"]["POSITION"]).astype(np.float64).reshape(-1, 3)
    order = np.arange(len(vertices))
    if "indices" in part:
        order = buffers.numbers(part["indices"]).ravel().astype(np.int64)
    faces = _faces(order, mode)
    require_indices(faces, len(vertices), f"glTF: mesh {name!r}")
    if not len(faces):
        return None
    return Body(name, vertices, faces, _albedo(part, tree, buffers, faces, remarks))


def _faces(order: np.ndarray, mode: int) -> Int64[np.ndarray, "m 3"]:
    if mode == TRIANGLES:
        return order[: len(order) // 3 * 3].reshape(-1, 3).astype(np.int64)
    count = max(len(order) - 2, 0)
    i = np.arange(count)
    if mode == FAN:
        return np.stack([order[np.zeros(count, int)], order[i + 1], order[i + 2]], axis=1)
    odd = i % 2  # every other triangle of a strip runs the other way
    return np.stack([order[i], order[i + 1 + odd], order[i + 2 - odd]], axis=1).reshape(-1, 3)


def _albedo(
    part: dict[str, Any],
    tree: dict[str, Any],
    buffers: Buffers,
    faces: Int64[np.ndarray, "m 3"],
    remarks: list[str],
) -> Float64[np.ndarray, "m 3"]:
    """Factor x picture x vertex colour; factors and vertex colours are linear by the standard."""
    material = tree["materials"][part["material"]] if "material" in part else {}
    paint = material.get("pbrMetallicRoughness", {})
    stated, albedo = "baseColorFactor" in paint, np.ones((len(faces), 3))
    albedo *= np.array(paint.get("baseColorFactor", [1, 1, 1])[:3], np.float64)
    if "COLOR_0" in part["attributes"]:
        albedo *= buffers.numbers(part["attributes"]["COLOR_0"])[faces].mean(axis=1)[:, :3]
        stated = True
    if "baseColorTexture" in paint:
        picture = _picture(part, tree, buffers, paint["baseColorTexture"], faces)
        remarks.append(texture.REMARK if picture is not None else texture.UNREADABLE)
        if picture is not None:
            albedo, stated = albedo * picture, True
    return albedo if stated else unpainted(len(faces))


def _picture(
    part: dict[str, Any],
    tree: dict[str, Any],
    buffers: Buffers,
    paint: dict[str, Any],
    faces: Int64[np.ndarray, "m 3"],
) -> Float64[np.ndarray, "m 3"] | None:
    uv = part["attributes"].get(f"TEXCOORD_{paint.get('texCoord', 0)}")
    source = tree["textures"][paint["index"]].get("source")
    if uv is None or source is None:
        return None
    image = tree["images"][source]
    inside = "bufferView" in image
    try:
        data = buffers.view(image["bufferView"]) if inside else buffers.load(image["uri"])
    except BadPart:  # a picture that is not there leaves the shape as it is
        return None
    corners = buffers.numbers(uv).astype(np.float64)[faces]
    return texture.sampled(data, corners * (1, -1) + (0, 1))  # glTF counts v downwards
