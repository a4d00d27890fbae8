"""The points in a file of a format of meshes: its vertices, or drawn of its faces."""

from pathlib import Path

import numpy as np
import trimesh
from jaxtyping import Float64, Int64

from industnerf.errors import BadPart
from industnerf.external.cloud_content import MAX_COORDINATE, CloudContent
from industnerf.geometry.sampling import sample_surface
from industnerf.parts.io.readers import read_solids
from industnerf.parts.io.readers.formats import GLB, GLTF
from industnerf.parts.io.readers.mesh_content import Y_UP, MeshContent
from industnerf.parts.io.readers.obj import parse_obj
from industnerf.parts.io.readers.off import read_off
from industnerf.parts.io.readers.ply import read_ply
from industnerf.parts.io.readers.stl import read_stl

# vertices, faces, and remarks on the file
LoadedMesh = tuple[Float64[np.ndarray, "n 3"], Int64[np.ndarray, "m 3"], list[str]]
Y_UP_FORMATS = (GLB.name, GLTF.name)  # by their standard, which not every program follows
SH_ZERO = 0.28209479177387814  # the spherical harmonic of degree 0: 1 / (2 sqrt(pi))


def read_mesh(file: Path, cap: int, rng: np.random.Generator) -> CloudContent:
    """`cap` points drawn evenly by area of the faces, or else the vertices.

    Where most vertices belong to no face, the file is a cloud.  Raises BadPart if it cannot be
    read, or its faces have no area, or a corner that is not finite as float32.
    """
    if not file.stat().st_size:
        raise BadPart("the file is empty (0 bytes)")
    suffix = file.suffix.lower()
    if suffix == ".ply" and not any(len(body.faces) for body in read_ply(file).bodies):
        return _read_ply_cloud(file)
    if suffix not in READERS:
        return _read_cad(file, cap, rng)
    vertices, faces, warnings = READERS[suffix](file)
    if not len(faces):
        return CloudContent(vertices, tuple(warnings))
    num_unreferenced = len(vertices) - len(np.unique(faces))
    if 2 * num_unreferenced > len(vertices):
        warnings.append(
            f"{num_unreferenced} of its {len(vertices)} vertices belong to no face: it is taken as "
            f"a cloud of all its vertices, without its faces ({len(faces)})"
        )
        return CloudContent(vertices, tuple(warnings))
    if num_unreferenced:
        warnings.append(
            f"{num_unreferenced} of its {len(vertices)} vertices belong to no face and do not count"
        )
    return _sample_faces(vertices, faces, tuple(warnings), cap, rng)


def _sample_faces(
    vertices: np.ndarray,
    faces: np.ndarray,
    warnings: tuple[str, ...],
    cap: int,
    rng: np.random.Generator,
) -> CloudContent:
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
            f"{num_too_large} of its {len(faces)} faces have a corner that is too large: a "
            f"coordinate of {largest:.3g}, and float32 ends at {MAX_COORDINATE:.3g}"
        )
    try:
        points = sample_surface(vertices, faces, cap, rng)[0]
    except ValueError as error:
        raise BadPart(str(error)) from None
    drawn = f"a mesh of {len(faces)} faces: {cap} points are drawn of it, evenly by area"
    return CloudContent(points, (*warnings, drawn), num_faces=len(faces))


def _read_cad(file: Path, cap: int, rng: np.random.Generator) -> CloudContent:
    """A mesh of any other format that `parts check` reads, as the stages read it: in mm, z up."""
    solids = read_solids(file, "mm")
    meshes = [solid.mesh for solid in solids.solids]
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces.astype(np.int64) + n for mesh, n in zip(meshes, starts, strict=False)]
    vertices = np.concatenate([mesh.vertices for mesh in meshes]).astype(np.float64)
    warnings = solids.warnings
    if solids.unit != "mm, stated" and solids.unit.endswith(", stated"):
        warnings = (*warnings, f"its unit is {solids.unit}; its points are turned into mm")
    content = _sample_faces(vertices, np.concatenate(faces), warnings, cap, rng)
    if solids.format not in Y_UP_FORMATS:
        return content
    return CloudContent(**vars(content) | {"own_axes": content.points @ Y_UP[:3, :3]})


def _read_ply_cloud(file: Path) -> CloudContent:
    """The vertices of a PLY without faces, and whatever it says of each."""
    loaded = trimesh.load(file, process=False)
    vertices = getattr(loaded, "vertices", np.zeros((0, 3)))  # of no point it makes a scene
    points = np.asarray(vertices, np.float64)
    raw = loaded.metadata.get("_ply_raw", {}).get("vertex", {}).get("data")
    if raw is None or not len(points):
        return CloudContent(points)
    names = raw.dtype.names if isinstance(raw, np.ndarray) else tuple(raw)

    def columns(*wanted: str) -> np.ndarray | None:
        if not set(wanted) <= set(names):
            return None
        return np.stack([np.asarray(raw[name], np.float64).ravel() for name in wanted], axis=1)

    harmonics, logit = columns("f_dc_0", "f_dc_1", "f_dc_2"), columns("opacity")
    colors, confidence = columns("red", "green", "blue"), columns("confidence")
    is_splats = logit is not None and (harmonics is not None or "scale_0" in names)
    if colors is None and harmonics is not None:
        colors = 255 * np.clip(0.5 + SH_ZERO * harmonics, 0, 1)
    return CloudContent(
        points,
        colors=None if colors is None else colors.astype(np.uint8),
        confidence=None if confidence is None else confidence[:, 0],
        opacity=1 / (1 + np.exp(-np.clip(logit[:, 0], -80, 80))) if is_splats else None,
    )


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
    ".ply": lambda file: _merge_bodies(read_ply(file)),
    ".obj": _load_obj,
    ".stl": lambda file: _merge_bodies(read_stl(file)[1]),
    ".off": lambda file: _merge_bodies(read_off(file)),
}
