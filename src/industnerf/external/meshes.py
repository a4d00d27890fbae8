"""The points in a PLY, OBJ, STL or OFF file: its vertices, or drawn of its faces."""

from pathlib import Path

import numpy as np
import trimesh
from jaxtyping import Float64, Int64

from industnerf.errors import BadPart
from industnerf.geometry.sampling import sample_surface
from industnerf.parts.io.readers.mesh_content import MeshContent
from industnerf.parts.io.readers.obj import parse_obj
from industnerf.parts.io.readers.off import read_off
from industnerf.parts.io.readers.ply import read_ply
from industnerf.parts.io.readers.stl import read_stl

# vertices, faces, and remarks on the file
LoadedMesh = tuple[Float64[np.ndarray, "n 3"], Int64[np.ndarray, "m 3"], list[str]]
MAX_COORDINATE = float(np.finfo(np.float32).max)  # clouds are kept as float32


def read_mesh(
    file: Path, cap: int, rng: np.random.Generator
) -> tuple[Float64[np.ndarray, "n 3"], list[str]]:
    """`cap` points drawn evenly by area of the faces, or else the vertices; and remarks.

    Where most vertices belong to no face, the file is a cloud.  Raises BadPart if it cannot be
    read, or its faces have no area, or a corner that is not finite as float32.
    """
    if not file.stat().st_size:
        raise BadPart("the file is empty (0 bytes)")
    vertices, faces, warnings = READERS[file.suffix.lower()](file)
    if not len(faces):
        return vertices, warnings
    num_unreferenced = len(vertices) - len(np.unique(faces))
    if 2 * num_unreferenced > len(vertices):
        warnings.append(
            f"{num_unreferenced} of its {len(vertices)} vertices belong to no face: it is taken as a cloud "
            f"of all its vertices, without its faces ({len(faces)})"
        )
        return vertices, warnings
    if num_unreferenced:
        warnings.append(
            f"{num_unreferenced} of its {len(vertices)} vertices belong to no face and do not count"
        )
    return _sample_faces(vertices, faces, cap, rng), warnings


def _sample_faces(
    vertices: np.ndarray, faces: np.ndarray, cap: int, rng: np.random.Generator
) -> Float64[np.ndarray, "n 3"]:
    corners = vertices[faces]
    finite = np.isfinite(corners).all(axis=(1, 2))
    if not finite.all():
        raise BadPart(
            f"{(~finite).sum()} of its {len(faces)} faces have a corner that is not finite"
        )
    if num_too_large := int(
        (np.abs(corners) > MAX_COORDINATE).any(axis=(1, 2)).sum()
    ):  # areas may overflow
        largest = corners.flat[np.abs(corners).argmax()]
        raise BadPart(
            f"{num_too_large} of its {len(faces)} faces have a corner that is too large: a coordinate of "
            f"{largest:.3g}, and float32 ends at {MAX_COORDINATE:.3g}"
        )
    try:
        return sample_surface(vertices, faces, cap, rng)[0]
    except ValueError as error:
        raise BadPart(str(error)) from None


def _load_ply(file: Path) -> LoadedMesh:
    bodies = read_ply(file)
    if any(len(body.faces) for body in bodies.bodies):
        return _merge_bodies(bodies)
    cloud = trimesh.load(file, process=False)  # of a file without faces the other reads nothing
    vertices = getattr(cloud, "vertices", np.zeros((0, 3)))  # of no point it makes a scene
    return np.asarray(vertices, np.float64), np.zeros((0, 3), np.int64), []


def _load_obj(file: Path) -> LoadedMesh:
    """By lines: readers of meshes leave out vertices that belong to no face."""
    obj = parse_obj(file)
    corners = [corner for group in obj.objects for corner in group.corners]
    vertices = np.array(obj.points, np.float64).reshape(-1, 3)
    return vertices, np.array(corners, np.int64).reshape(-1, 3), obj.warnings


def _merge_bodies(content: MeshContent) -> LoadedMesh:
    """All bodies as one."""
    starts = np.cumsum([0, *(len(body.vertices) for body in content.bodies)])
    faces = [body.faces + start for body, start in zip(content.bodies, starts, strict=False)]
    vertices = [body.vertices for body in content.bodies]
    return (
        np.concatenate([np.zeros((0, 3)), *vertices]),
        np.concatenate([np.zeros((0, 3), np.int64), *faces]),
        list(content.warnings),
    )


READERS = {
    ".ply": _load_ply,
    ".obj": _load_obj,
    ".stl": lambda file: _merge_bodies(read_stl(file)[1]),
    ".off": lambda file: _merge_bodies(read_off(file)),
}
