"""The points in a PLY, OBJ, STL or OFF file: its vertices, or drawn of its faces."""

from pathlib import Path

import numpy as np
import trimesh
from jaxtyping import Float64, Int64

from industnerf.errors import BadPart
from industnerf.geometry.sampling import sample_surface
from industnerf.parts.reading.content import Content
from industnerf.parts.reading.obj_lines import scene_of
from industnerf.parts.reading.off import read_off
from industnerf.parts.reading.ply import read_ply
from industnerf.parts.reading.stl import read_stl

# vertices, faces, and remarks on the file
Shape = tuple[Float64[np.ndarray, "n 3"], Int64[np.ndarray, "m 3"], list[str]]
LARGEST = float(np.finfo(np.float32).max)  # clouds are kept as float32


def read_mesh(
    file: Path, cap: int, rng: np.random.Generator
) -> tuple[Float64[np.ndarray, "n 3"], list[str]]:
    """`cap` points drawn evenly by area of the faces, or else the vertices; and remarks.

    Where most vertices belong to no face, the file is a cloud.  Raises BadPart if it cannot be
    read, or its faces have no area, or a corner that is not finite as float32.
    """
    if not file.stat().st_size:
        raise BadPart("the file is empty (0 bytes)")
    vertices, faces, remarks = READERS[file.suffix.lower()](file)
    if not len(faces):
        return vertices, remarks
    loose = len(vertices) - len(np.unique(faces))
    if 2 * loose > len(vertices):
        remarks.append(
            f"{loose} of its {len(vertices)} vertices belong to no face: it is taken as a cloud "
            f"of all its vertices, without its faces ({len(faces)})"
        )
        return vertices, remarks
    if loose:
        remarks.append(
            f"{loose} of its {len(vertices)} vertices belong to no face and do not count"
        )
    return _drawn(vertices, faces, cap, rng), remarks


def _drawn(
    vertices: np.ndarray, faces: np.ndarray, cap: int, rng: np.random.Generator
) -> Float64[np.ndarray, "n 3"]:
    corners = vertices[faces]
    finite = np.isfinite(corners).all(axis=(1, 2))
    if not finite.all():
        raise BadPart(
            f"{(~finite).sum()} of its {len(faces)} faces have a corner that is not finite"
        )
    if far := int((np.abs(corners) > LARGEST).any(axis=(1, 2)).sum()):  # areas may overflow
        largest = corners.flat[np.abs(corners).argmax()]
        raise BadPart(
            f"{far} of its {len(faces)} faces have a corner that is too large: a coordinate of "
            f"{largest:.3g}, and float32 ends at {LARGEST:.3g}"
        )
    try:
        return sample_surface(vertices, faces, cap, rng)[0]
    except ValueError as error:
        raise BadPart(str(error)) from None


def _ply(file: Path) -> Shape:
    bodies = read_ply(file)
    if any(len(body.faces) for body in bodies.bodies):
        return _joined(bodies)
    cloud = trimesh.load(file, process=False)  # of a file without faces the other reads nothing
    vertices = getattr(cloud, "vertices", np.zeros((0, 3)))  # of no point it makes a scene
    return np.asarray(vertices, np.float64), np.zeros((0, 3), np.int64), []


def _obj(file: Path) -> Shape:
    """By lines: readers of meshes leave out vertices that belong to no face."""
    scene = scene_of(file)
    corners = [corner for each in scene.objects for corner in each.corners]
    vertices = np.array(scene.points, np.float64).reshape(-1, 3)
    return vertices, np.array(corners, np.int64).reshape(-1, 3), scene.remarks


def _joined(content: Content) -> Shape:
    """All bodies as one."""
    starts = np.cumsum([0, *(len(body.vertices) for body in content.bodies)])
    faces = [body.faces + start for body, start in zip(content.bodies, starts, strict=False)]
    vertices = [body.vertices for body in content.bodies]
    return (
        np.concatenate([np.zeros((0, 3)), *vertices]),
        np.concatenate([np.zeros((0, 3), np.int64), *faces]),
        list(content.remarks),
    )


READERS = {
    ".ply": _ply,
    ".obj": _obj,
    ".stl": lambda file: _joined(read_stl(file)[1]),
    ".off": lambda file: _joined(read_off(file)),
}
