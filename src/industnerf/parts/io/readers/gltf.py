"""glTF 2.0, binary or JSON: one body per node, in meters and y up as the standard says."""

import base64
import binascii
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.io.readers import up_axis
from industnerf.parts.io.readers.gltf_buffers import Buffers
from industnerf.parts.io.readers.gltf_mesh import read_primitive
from industnerf.parts.io.readers.mesh_content import (
    MeshBody,
    MeshContent,
    concatenate_bodies,
    transform_body,
)
from industnerf.parts.io.readers.sidecars import resolve_sidecar

MM_PER_METER = 1000.0


def read_glb(path: Path) -> MeshContent:
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
    offset = 12
    while offset + 8 <= length:
        size = int.from_bytes(data[offset : offset + 4], "little")
        kind = data[offset + 4 : offset + 8]
        if offset + 8 + size > length:
            raise BadPart(f"GLB: a chunk promises {size} bytes, {length - offset - 8} are left")
        chunks.setdefault(kind, data[offset + 8 : offset + 8 + size])
        offset += 8 + size
    return _read_content(path, chunks.get(b"JSON", b""), chunks.get(b"BIN\0"))


def read_gltf(path: Path) -> MeshContent:
    """Raises BadPart if the JSON is broken, a buffer is missing, or a count fits no buffer."""
    return _read_content(path, path.read_bytes(), None)


def _read_content(path: Path, text: bytes, blob: bytes | None) -> MeshContent:
    try:
        tree = json.loads(text)
        if not isinstance(tree, dict):
            raise BadPart("glTF: its JSON is no object")
        warnings: list[str] = []
        buffers = Buffers(tree, _make_loader(path, blob))
        bodies = tuple(_bodies(tree, buffers, warnings))
    except (ValueError, KeyError, IndexError, TypeError, AttributeError, RecursionError) as error:
        raise BadPart(f"glTF: {type(error).__name__}: {error}") from None
    return MeshContent(bodies, MM_PER_METER, "m", True, tuple(dict.fromkeys(warnings)))


def _make_loader(path: Path, blob: bytes | None) -> Callable[[str | None], bytes]:
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
        sidecar = resolve_sidecar(path, uri)
        if sidecar is None:
            raise BadPart(f"glTF: {uri[:80]!r}, which it names, is not beside it")
        return sidecar.read_bytes()

    return load


def _bodies(tree: dict[str, Any], buffers: Buffers, warnings: list[str]) -> list[MeshBody]:
    """Every mesh of the scene, placed.  Nodes form a tree: one that is met twice is refused."""
    nodes, meshes, bodies = tree.get("nodes", []), tree.get("meshes", []), []
    scenes = tree.get("scenes")
    roots = scenes[tree.get("scene", 0)].get("nodes", []) if scenes else _roots(nodes)
    stack, visited = [(index, up_axis.Y_UP) for index in reversed(roots)], set()
    cache: dict[int, MeshBody | None] = {}
    while stack:
        index, parent_matrix = stack.pop()
        if index in visited or index < 0:
            raise BadPart(f"glTF: node {index} has two parents, or is its own")
        visited.add(index)
        node = nodes[index]
        matrix = parent_matrix @ _matrix(node)
        if "mesh" in node:
            mesh_index = node["mesh"]
            if mesh_index not in cache:
                cache[mesh_index] = _mesh(meshes[mesh_index], tree, buffers, warnings)
            body = cache[mesh_index]
            if body is not None:
                bodies.append(transform_body(body, matrix, str(node.get("name") or body.name)))
        stack += [(child, matrix) for child in reversed(node.get("children", []))]
    return bodies


def _roots(nodes: list[dict[str, Any]]) -> list[int]:
    children = {child for node in nodes for child in node.get("children", [])}
    return [index for index in range(len(nodes)) if index not in children]


def _mesh(
    mesh: dict[str, Any], tree: dict[str, Any], buffers: Buffers, warnings: list[str]
) -> MeshBody | None:
    name = str(mesh.get("name") or "solid")
    pieces = [read_primitive(each, tree, buffers, name, warnings) for each in mesh["primitives"]]
    nonempty = [piece for piece in pieces if piece is not None]
    return concatenate_bodies(name, nonempty) if nonempty else None


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
