"""glTF 2.0, binary or JSON: one body per node, in meters and y up as the standard says.

Not through trimesh, which leaves out triangle fans, makes one body of each material, keeps linear
factors in 8 bits and reads compressed accessors as zeros (benchmarks/readers.md).
"""

import base64
import binascii
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.errors import BadPart
from industnerf.parts.io.readers.colors import TEXTURE_REDUCED, TEXTURE_UNREADABLE, sample_texture
from industnerf.parts.io.readers.mesh_content import (
    Y_UP,
    MeshBody,
    MeshContent,
    concatenate_bodies,
    fan_triangles,
    require_valid_indices,
    strip_triangles,
    transform_body,
    unstated_albedo,
)
from industnerf.parts.io.readers.sidecars import resolve_sidecar

MM_PER_METER = 1000.0
TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
POINTS, TRIANGLES, STRIP, FAN = 0, 4, 5, 6


class Buffers:
    """The buffers of one file, each loaded once."""

    def __init__(self, tree: dict[str, Any], load: Callable[[str | None], bytes]) -> None:
        self._tree, self.load = tree, load
        self._loaded: dict[int, bytes] = {}

    def read_view(self, index: int) -> bytes:
        """The bytes of a buffer view; raises BadPart if the buffer is shorter."""
        view = self._tree["bufferViews"][index]
        offset, length, buffer_index = view.get("byteOffset", 0), view["byteLength"], view["buffer"]
        if buffer_index not in self._loaded:
            self._loaded[buffer_index] = self.load(self._tree["buffers"][buffer_index].get("uri"))
        data = self._loaded[buffer_index]
        if offset < 0 or length < 0 or offset + length > len(data):
            raise BadPart(f"glTF: a view ends at byte {offset + length} of a buffer of {len(data)}")
        return data[offset : offset + length]

    def read_accessor(self, index: int) -> np.ndarray:
        """(count, width) numbers of an accessor; whole ones that stand for shares become shares."""
        accessor = self._tree["accessors"][index]
        if "bufferView" not in accessor or "sparse" in accessor:
            raise BadPart("glTF: an accessor is sparse or compressed (Draco?); export it plainly")
        dtype = np.dtype(TYPES[accessor["componentType"]])
        count, width = accessor["count"], WIDTH[accessor["type"]]
        data, offset = self.read_view(accessor["bufferView"]), accessor.get("byteOffset", 0)
        row = dtype.itemsize * width
        stride = self._tree["bufferViews"][accessor["bufferView"]].get("byteStride", row)
        if (
            count < 1
            or stride < row
            or offset < 0
            or offset + (count - 1) * stride + row > len(data)
        ):
            raise BadPart(
                f"glTF: an accessor promises {count} rows of {row} bytes, its view holds "
                f"{len(data)}"
            )
        table = np.ndarray((count, width), dtype, data, offset, (stride, dtype.itemsize)).copy()
        if accessor.get("normalized") and dtype.kind in "iu":
            return table / np.iinfo(dtype).max
        return table


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
        num_points = 0 if bodies else _count_points(tree)
    except (ValueError, KeyError, IndexError, TypeError, AttributeError, RecursionError) as error:
        raise BadPart(f"glTF: {type(error).__name__}: {error}") from None
    return MeshContent(
        bodies, MM_PER_METER, "m", True, tuple(dict.fromkeys(warnings)), num_points=num_points
    )


def _count_points(tree: dict[str, Any]) -> int:
    """The points of all primitives that are drawn as points."""
    pieces = [piece for mesh in tree.get("meshes", []) for piece in mesh["primitives"]]
    return sum(
        tree["accessors"][piece["attributes"]["POSITION"]]["count"]
        for piece in pieces
        if piece.get("mode") == POINTS
    )


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
    stack, visited = [(index, Y_UP) for index in reversed(roots)], set()
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


def read_primitive(
    node: dict[str, Any], tree: dict[str, Any], buffers: Buffers, name: str, warnings: list[str]
) -> MeshBody | None:
    """The body of the primitive `node`; None if it is points or lines, or empty."""
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


def _faces(indices: Int64[np.ndarray, "k"], mode: int) -> Int64[np.ndarray, "m 3"]:
    if mode == TRIANGLES:
        return indices[: len(indices) // 3 * 3].reshape(-1, 3)
    return strip_triangles(indices) if mode == STRIP else fan_triangles(indices)


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
        warnings.append(TEXTURE_REDUCED if texture_albedo is not None else TEXTURE_UNREADABLE)
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
    return sample_texture(data, corners * (1, -1) + (0, 1))  # glTF counts v downwards
