"""STL, PLY and OBJ of a mesh: lengths in mm, colors in sRGB as these formats have them.

STL has no colors; PLY has one a face; OBJ names the finishes and has them in an MTL beside it.
"""

from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.artifacts.ply import write_ply
from industnerf.parts.io.readers.colors import linear_to_srgb8
from industnerf.parts.validation import checks

WHITE = (1.0, 1.0, 1.0)  # of a finish that states no color, as these formats have it
STL_FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


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
