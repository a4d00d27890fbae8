"""glTF 2.0, binary or JSON: one body per node, in metres and y up as the standard says."""

import base64
import binascii
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.reading import up
from industnerf.parts.reading.content import Body, Content, joined, placed
from industnerf.parts.reading.gltf_buffers import Buffers
from industnerf.parts.reading.gltf_mesh import primitive
from industnerf.parts.reading.sidecars import named

MM = 1000.0


def read_glb(path: Path) -> Content:
    """Raises BadPart if the chunks do not fit the file, or see `read_gltf`."""
    data = path.read_bytes()
    version, length = (int.from_bytes(data[i : i + 4], "little") for i in (4, 8))
    if len(data) < 20 or version != 2:
        raise BadPart(f"GLB: version {version} and {len(data)} bytes; version 2 is read")
    if length > len(data):
        raise BadPart(
            f"GLB: header promises {length} bytes, the file holds {len(data)}: it is cut short"
        )
    chunks: dict[bytes, bytes] = {}
    at = 12
    while at + 8 <= length:
        size, kind = int.from_bytes(data[at : at + 4], "little"), data[at + 4 : at + 8]
        if at + 8 + size > length:
            raise BadPart(f"GLB: a chunk promises {size} bytes, {length - at - 8} are left")
        chunks.setdefault(kind, data[at + 8 : at + 8 + size])
        at += 8 + size
    return _content(path, chunks.get(b"JSON", b""), chunks.get(b"BIN\0"))


def read_gltf(path: Path) -> Content:
    """Raises BadPart if the JSON is broken, a buffer is missing, or a count fits no buffer."""
    return _content(path, path.read_bytes(), None)


def _content(path: Path, text: bytes, blob: bytes | None) -> Content:
    try:
        tree = json.loads(text)
        if not isinstance(tree, dict):
            raise BadPart("glTF: its JSON is no object")
        remarks: list[str] = []
        buffers = Buffers(tree, _loader(path, blob))
        bodies = tuple(_bodies(tree, buffers, remarks))
    except (ValueError, KeyError, IndexError, TypeError, AttributeError, RecursionError) as error:
        raise BadPart(f"glTF: {type(error).__name__}: {error}") from None
    return Content(bodies, MM, "m", True, tuple(dict.fromkeys(remarks)))


def _loader(path: Path, blob: bytes | None) -> Callable[[str | None], bytes]:
    def load(uri: str | None) -> bytes:
        if uri is None:
            if blob is None:
                raise BadPart("glTF: a buffer has neither an address nor a binary chunk")
            return blob
        if uri.startswith("data:"):
            try:
                return base64.b64decode(uri.partition("base64,")[2], validate=True)
            except binascii.Error as error:
                raise BadPart(f"glTF: an embedded buffer is broken: {error}") from None
        beside = named(path, uri)
        if beside is None:
            raise BadPart(f"glTF: {uri[:80]!r}, which it names, is not beside it")
        return beside.read_bytes()

    return load


def _bodies(tree: dict[str, Any], buffers: Buffers, remarks: list[str]) -> list[Body]:
    """Every mesh of the scene, placed.  Nodes form a tree: one that is met twice is refused."""
    nodes, meshes, found = tree.get("nodes", []), tree.get("meshes", []), []
    scenes = tree.get("scenes")
    roots = scenes[tree.get("scene", 0)].get("nodes", []) if scenes else _roots(nodes)
    todo, seen = [(index, up.Y_UP) for index in reversed(roots)], set()
    made: dict[int, Body | None] = {}
    while todo:
        index, above = todo.pop()
        if index in seen or index < 0:
            raise BadPart(f"glTF: node {index} has two parents, or is its own")
        seen.add(index)
        node = nodes[index]
        matrix = above @ _matrix(node)
        if "mesh" in node:
            which = node["mesh"]
            if which not in made:
                made[which] = _mesh(meshes[which], tree, buffers, remarks)
            body = made[which]
            if body is not None:
                found.append(placed(body, matrix, str(node.get("name") or body.name)))
        todo += [(child, matrix) for child in reversed(node.get("children", []))]
    return found


def _roots(nodes: list[dict[str, Any]]) -> list[int]:
    children = {child for node in nodes for child in node.get("children", [])}
    return [index for index in range(len(nodes)) if index not in children]


def _mesh(
    mesh: dict[str, Any], tree: dict[str, Any], buffers: Buffers, remarks: list[str]
) -> Body | None:
    name = str(mesh.get("name") or "solid")
    pieces = [primitive(each, tree, buffers, name, remarks) for each in mesh["primitives"]]
    solid = [piece for piece in pieces if piece is not None]
    return joined(name, solid) if solid else None


def _matrix(node: dict[str, Any]) -> Float64[np.ndarray, "4 4"]:
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T
    x, y, z, w = np.array(node.get("rotation", [0, 0, 0, 1]), np.float64)
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, :3] *= np.array(node.get("scale", [1, 1, 1]), np.float64)
    matrix[:3, 3] = np.array(node.get("translation", [0, 0, 0]), np.float64)
    return matrix
