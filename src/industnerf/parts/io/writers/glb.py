"""GLB: glTF 2.0 in one binary file.

As the standard has it: meters, +Y up, base colors linear.  All faces share one list of vertices,
so that a closed surface is closed in the file too; each finish is a primitive and a material.
"""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.parts.io.writers.mesh_formats import WHITE

FLOAT, UINT = 5126, 5125  # component types of the standard
VERTEX_TARGET, INDEX_TARGET = 34962, 34963  # its buffer targets
Z_TO_Y_UP = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]  # a quarter turn about x, as a quaternion
MM_PER_METER = 1000.0


def write_glb(path: Path, mesh: Mesh, finishes: tuple[Appearance, ...]) -> None:
    """Write `mesh`, one material a finish that it has."""
    positions = (mesh.vertices / MM_PER_METER).astype("<f4")
    used = np.unique(mesh.finish).tolist()
    chunks = [positions.tobytes()]
    chunks += [mesh.faces[mesh.finish == number].astype("<u4").tobytes() for number in used]
    content = _gltf_tree(path.stem, positions, [len(chunk) for chunk in chunks])
    content["materials"] = [_material(finishes[number]) for number in used]
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    binary = b"".join(chunks)  # of floats and 32-bit indices: already a multiple of 4
    with path.open("wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def _gltf_tree(name: str, positions: np.ndarray, lengths: list[int]) -> dict[str, Any]:
    """The scene: buffer view and accessor 0 are the vertices, i + 1 the faces of material i."""
    starts = np.cumsum([0, *lengths]).tolist()
    views = [
        {"buffer": 0, "byteOffset": start, "byteLength": length, "target": target}
        for start, length, target in zip(
            starts, lengths, [VERTEX_TARGET] + [INDEX_TARGET] * (len(lengths) - 1), strict=False
        )
    ]
    box = {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
    vertices = {"bufferView": 0, "componentType": FLOAT, "count": len(positions), "type": "VEC3"}
    faces = [
        {"bufferView": i, "componentType": UINT, "count": length // 4, "type": "SCALAR"}
        for i, length in enumerate(lengths[1:], 1)
    ]
    primitives = [
        {"attributes": {"POSITION": 0}, "indices": i + 1, "material": i} for i in range(len(faces))
    ]
    return {
        "asset": {"version": "2.0", "generator": "industnerf"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": name, "mesh": 0, "rotation": Z_TO_Y_UP}],
        "meshes": [{"name": name, "primitives": primitives}],
        "accessors": [vertices | box, *faces],
        "bufferViews": views,
        "buffers": [{"byteLength": starts[-1]}],
    }


def _material(finish: Appearance) -> dict[str, Any]:
    return {
        "name": finish.name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(finish.albedo or WHITE), 1.0],
            "metallicFactor": finish.metallic,
            "roughnessFactor": finish.roughness,
        },
    }
