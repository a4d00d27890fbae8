"""STL, PLY, OBJ and GLB of a mesh.

STL, PLY and OBJ have lengths in mm and colors in sRGB.  STL has no colors; PLY has one a face; OBJ
names the finishes and has them in an MTL beside it.  GLB, glTF 2.0 in one binary file, has meters,
+Y up and linear base colors, as the standard asks.  Its faces share one list of vertices, so that
a closed surface is closed in the file too; each finish is a primitive and a material.
"""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Int32, UInt8

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.artifacts.ply import write_ply
from industnerf.parts.io.readers.colors import linear_to_srgb8
from industnerf.parts.validation import checks

WHITE = (1.0, 1.0, 1.0)  # of a finish that states no color, as these formats have it
STL_FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
FLOAT, UINT = 5126, 5125  # component types of the standard
VERTEX_TARGET, INDEX_TARGET = 34962, 34963  # its buffer targets
Z_TO_Y_UP = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]  # a quarter turn about x, as a quaternion
MM_PER_METER = 1000.0


def write_stl(path: Path, mesh: Mesh, finishes: tuple[Appearance, ...]) -> None:
    """Binary STL."""
    faces = np.zeros(len(mesh.faces), STL_FACE)
    normals = checks.double_area_normals(mesh.vertices, mesh.faces)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    faces["normal"], faces["corners"] = normals / np.where(length > 0, length, 1), mesh.triangles
    with path.open("wb") as file:
        file.write(b"binary STL, lengths in mm".ljust(80))
        file.write(np.uint32(len(faces)).tobytes() + faces.tobytes())


def write_face_ply(path: Path, mesh: Mesh, finishes: tuple[Appearance, ...]) -> None:
    """Binary PLY with a color a face."""
    colors = srgb_colors(finishes)[mesh.finish]
    write_ply(path, mesh.vertices, faces=mesh.faces, face_colors=colors)


def write_obj(path: Path, mesh: Mesh, finishes: tuple[Appearance, ...]) -> None:
    """OBJ, its faces grouped by finish, and an MTL of the same name."""
    lines = ["# lengths in mm", f"mtllib {path.with_suffix('.mtl').name}", f"o {path.stem}"]
    lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in mesh.vertices.tolist()]
    for number, finish in enumerate(finishes):
        lines.append(f"usemtl {_material_name(finish)}")
        faces = mesh.faces[mesh.finish == number] + 1
        lines += [f"f {a} {b} {c}" for a, b, c in faces.tolist()]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    path.with_suffix(".mtl").write_text(_format_mtl(finishes), encoding="utf-8")


def srgb_colors(finishes: tuple[Appearance, ...]) -> UInt8[np.ndarray, "k 3"]:
    """The finishes in sRGB."""
    return linear_to_srgb8(np.array([finish.albedo or WHITE for finish in finishes]))


def _format_mtl(finishes: tuple[Appearance, ...]) -> str:
    """Kd is the color; Pm and Pr, metallic and roughness, are the usual extension."""
    lines = []
    for finish, color in zip(finishes, srgb_colors(finishes) / 255, strict=True):
        lines += [f"newmtl {_material_name(finish)}", "Kd {:.6f} {:.6f} {:.6f}".format(*color)]
        lines += [f"Pm {finish.metallic:g}", f"Pr {finish.roughness:g}", "illum 2", ""]
    return "\n".join(lines)


def _material_name(finish: Appearance) -> str:
    return finish.name.replace(" ", "_")


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


def group_shells_by_solid(mesh: Mesh) -> list[list[Int32[np.ndarray, "k"]]]:
    """For each solid the faces of its shells, the outer one first.

    A shell of negative volume is a void of the smallest solid whose box holds it.
    """
    shells = _shells(mesh.faces)
    volumes = [checks.volume_mm3(mesh.vertices, mesh.faces[shell]) for shell in shells]
    ordered = sorted(zip(volumes, shells, strict=True), key=lambda pair: pair[0])
    solids = [[shell] for volume, shell in ordered if volume > 0]  # the smallest first
    for cavity in (shell for volume, shell in ordered if volume <= 0):
        containing = [solid for solid in solids if _box_contains(mesh, solid[0], cavity)]
        (containing or solids)[0].append(cavity)
    return solids


def _shells(faces: Int32[np.ndarray, "m 3"]) -> list[Int32[np.ndarray, "k"]]:
    piece = checks.surface_components(faces)
    return [np.flatnonzero(piece == each).astype(np.int32) for each in np.unique(piece)]


def _box_contains(mesh: Mesh, outer: Int32[np.ndarray, "k"], inner: Int32[np.ndarray, "j"]) -> bool:
    outer_points, inner_points = (mesh.triangles[faces].reshape(-1, 3) for faces in (outer, inner))
    return bool(
        (
            (outer_points.min(0) <= inner_points.min(0))
            & (inner_points.max(0) <= outer_points.max(0))
        ).all()
    )
