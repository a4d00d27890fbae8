"""STL, PLY and OBJ of a mesh: lengths in mm, colours in sRGB as these formats have them.

STL has no colours; PLY has one a face; OBJ names the finishes and has them in an MTL beside it.
"""

from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from industnerf.artifacts.finish import Finish
from industnerf.artifacts.part import Mesh
from industnerf.artifacts.ply import write_ply
from industnerf.parts import checks
from industnerf.parts.reading.paint import encoded

WHITE = (1.0, 1.0, 1.0)  # of a finish that states no colour, as these formats have it
FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def write_stl(path: Path, mesh: Mesh, finishes: tuple[Finish, ...]) -> None:
    """Binary STL."""
    faces = np.zeros(len(mesh.faces), FACE)
    normals = checks.doubled_normals(mesh.vertices, mesh.faces)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    faces["normal"], faces["corners"] = normals / np.where(length > 0, length, 1), mesh.triangles
    with path.open("wb") as file:
        file.write(b"binary STL, lengths in mm".ljust(80))
        file.write(np.uint32(len(faces)).tobytes() + faces.tobytes())


def write_face_ply(path: Path, mesh: Mesh, finishes: tuple[Finish, ...]) -> None:
    """Binary PLY with a colour a face."""
    colours = colours_of(finishes)[mesh.finish]
    write_ply(path, mesh.vertices, faces=mesh.faces, face_colours=colours)


def write_obj(path: Path, mesh: Mesh, finishes: tuple[Finish, ...]) -> None:
    """OBJ, its faces grouped by finish, and an MTL of the same name."""
    lines = ["# lengths in mm", f"mtllib {path.with_suffix('.mtl').name}", f"o {path.stem}"]
    lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in mesh.vertices.tolist()]
    for number, finish in enumerate(finishes):
        lines.append(f"usemtl {_word(finish)}")
        faces = mesh.faces[mesh.finish == number] + 1
        lines += [f"f {a} {b} {c}" for a, b, c in faces.tolist()]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    path.with_suffix(".mtl").write_text(_mtl(finishes), encoding="utf-8")


def colours_of(finishes: tuple[Finish, ...]) -> UInt8[np.ndarray, "k 3"]:
    """The finishes in sRGB."""
    return encoded(np.array([finish.albedo or WHITE for finish in finishes]))


def _mtl(finishes: tuple[Finish, ...]) -> str:
    """Kd is the colour; Pm and Pr, metallic and roughness, are the usual extension."""
    lines = []
    for finish, colour in zip(finishes, colours_of(finishes) / 255, strict=True):
        lines += [f"newmtl {_word(finish)}", "Kd {:.6f} {:.6f} {:.6f}".format(*colour)]
        lines += [f"Pm {finish.metallic:g}", f"Pr {finish.roughness:g}", "illum 2", ""]
    return "\n".join(lines)


def _word(finish: Finish) -> str:
    return finish.name.replace(" ", "_")
