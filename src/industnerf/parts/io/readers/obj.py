"""Wavefront OBJ: one body per `o`.  Groups are not bodies, for many programs write one per face.

Not through trimesh, which fans concave polygons over their dents, joins the objects of a file,
reads one material library a file and keeps quiet about a missing one (benchmarks/readers.md).
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.io.readers.colors import TEXTURE_REDUCED, sample_texture, srgb_to_linear
from industnerf.parts.io.readers.formats import decode_text
from industnerf.parts.io.readers.mesh_content import MeshBody, MeshContent, unstated_albedo
from industnerf.parts.io.readers.polygons import triangulate_polygon
from industnerf.parts.io.readers.sidecars import resolve_sidecar


@dataclass
class ObjObject:
    """Triangles of one `o`, as they come."""

    name: str
    corners: list[tuple[int, int, int]] = field(default_factory=list)
    uvs: list[tuple[int, int, int]] = field(default_factory=list)
    materials: list[str] = field(default_factory=list)


@dataclass
class ObjScene:
    """What has been read so far."""

    points: list[list[float]] = field(default_factory=list)
    colors: dict[int, list[float]] = field(default_factory=dict)
    uvs: list[list[float]] = field(default_factory=list)
    objects: list[ObjObject] = field(default_factory=lambda: [ObjObject("")])
    libraries: list[str] = field(default_factory=list)
    current_material: str = ""
    num_degenerate: int = 0  # faces of fewer than three corners

    @property
    def warnings(self) -> list[str]:
        """What was left out."""
        return (
            [f"faces of fewer than 3 corners dropped: {self.num_degenerate}"]
            if self.num_degenerate
            else []
        )


@dataclass(frozen=True)
class Material:
    """What a face of it looks like; the picture goes before the color."""

    albedo: Float64[np.ndarray, "3"] | None
    image_path: Path | None


def read_obj(path: Path) -> MeshContent:
    """Raises BadPart that names the line if a face or a vertex makes no sense."""
    scene = parse_obj(path)
    warnings = scene.warnings
    materials = _read_materials(path, scene, warnings)
    objects = [obj_object for obj_object in scene.objects if obj_object.corners]
    points = np.array(scene.points, np.float64).reshape(-1, 3)
    bodies = [
        _body(scene, obj_object, points, materials, obj_object.name or f"solid {i}", warnings)
        for i, obj_object in enumerate(objects, start=1)
    ]
    warnings = list(dict.fromkeys(warnings))
    num_points = 0 if bodies else len(points)
    return MeshContent(tuple(bodies), None, None, False, tuple(warnings), num_points=num_points)


def _read_materials(path: Path, scene: ObjScene, warnings: list[str]) -> dict[str, Material]:
    materials: dict[str, Material] = {}
    for text in chain.from_iterable(map(_split_library_names, scene.libraries)):
        library = resolve_sidecar(path, text)
        if library is None:
            warnings.append(f"its materials are missing: {text[:80]}")
        else:
            materials |= read_mtl(library)
    return materials


def _split_library_names(line: str) -> list[str]:
    """The files that one `mtllib` names, each up to its ending, for names may hold blanks."""
    names = [""]
    for token in line.split():
        names[-1] = f"{names[-1]} {token}".lstrip()
        if token.lower().endswith(".mtl"):
            names.append("")
    return [name for name in names if name] or [line]


def _body(
    scene: ObjScene,
    obj_object: ObjObject,
    points: Float64[np.ndarray, "n 3"],
    materials: dict[str, Material],
    name: str,
    warnings: list[str],
) -> MeshBody:
    faces = np.array(obj_object.corners, np.int64)
    used, inverse = np.unique(faces, return_inverse=True)
    albedo = _vertex_albedo(scene, faces)
    material_names = np.array(obj_object.materials)
    for material in np.unique(material_names):
        definition, mask = materials.get(str(material)), material_names == material
        if definition is not None:
            stated = _material_albedo(
                scene, definition, np.array(obj_object.uvs, np.int64)[mask], warnings
            )
            albedo[mask] = albedo[mask] if stated is None else stated
    return MeshBody(name, points[used], inverse.reshape(-1, 3), albedo)


def _vertex_albedo(scene: ObjScene, faces: np.ndarray) -> Float64[np.ndarray, "m 3"]:
    if not scene.colors:
        return unstated_albedo(len(faces))
    table = unstated_albedo(len(scene.points))
    table[list(scene.colors)] = srgb_to_linear(np.array(list(scene.colors.values())))
    return table[faces].mean(axis=1)


def _material_albedo(
    scene: ObjScene, material: Material, uvs: np.ndarray, warnings: list[str]
) -> np.ndarray | None:
    """The albedo of faces of one material, for each or for all; None if it states none."""
    if material.image_path is not None and (uvs >= 0).all():
        sampled = sample_texture(material.image_path.read_bytes(), np.array(scene.uvs)[uvs])
        if sampled is not None:
            warnings.append(TEXTURE_REDUCED)
            return sampled
        warnings.append(f"picture {material.image_path.name} cannot be read")
    return material.albedo


def parse_obj(path: Path) -> ObjScene:
    """All that the file says; raises BadPart that names the line if one makes no sense."""
    scene = ObjScene()
    for number, line in logical_lines(decode_text(path.read_bytes())):
        try:
            parse_line(scene, line.split())
        except (ValueError, IndexError) as error:
            raise BadPart(f"OBJ: line {number}, {line.strip()[:60]!r}: {error}") from None
    return scene


def logical_lines(text: str) -> Iterator[tuple[int, str]]:
    """Each line, and its number; after a backslash it goes on in the next, as one line."""
    first, pending = 1, ""
    for number, line in enumerate(text.splitlines(), start=1):
        first = first if pending else number
        if line.endswith("\\"):
            pending += line[:-1] + " "
        else:
            yield first, pending + line
            pending = ""
    yield first, pending


def parse_line(scene: ObjScene, tokens: list[str]) -> None:
    """Add what one line says; raises ValueError or IndexError if it makes no sense."""
    key, rest = (tokens[0], tokens[1:]) if tokens else ("", [])
    if key == "v":
        if len(rest) < 3:
            raise ValueError("a vertex has three coordinates")
        numbers = [float(token) for token in rest]
        if len(rest) >= 6:
            scene.colors[len(scene.points)] = numbers[3:6]
        scene.points.append(numbers[:3])
    elif key == "vt":
        scene.uvs.append([*map(float, rest[:2]), 0.0, 0.0][:2])
    elif key == "f":
        _parse_face(scene, rest)
    elif key == "o":
        scene.objects.append(ObjObject(" ".join(rest)))
    elif key == "usemtl":
        scene.current_material = " ".join(rest)
    elif key == "mtllib":
        scene.libraries.append(" ".join(rest))


def _parse_face(scene: ObjScene, tokens: list[str]) -> None:
    parts = [token.split("/") for token in tokens]
    corners = [_parse_index(part[0], len(scene.points), "vertex") for part in parts]
    if len(corners) < 3:
        scene.num_degenerate += 1
        return
    textured = all(len(part) > 1 and part[1] for part in parts)
    uvs = [_parse_index(p[1], len(scene.uvs), "texture point") if textured else -1 for p in parts]
    triples = [(0, 1, 2)]
    if len(corners) > 3:
        triples = triangulate_polygon(np.array([scene.points[i] for i in corners])).tolist()
    target = scene.objects[-1]
    target.corners += [(corners[a], corners[b], corners[c]) for a, b, c in triples]
    target.uvs += [(uvs[a], uvs[b], uvs[c]) for a, b, c in triples]
    target.materials += [scene.current_material] * len(triples)


def _parse_index(token: str, count: int, label: str) -> int:
    """From 1, or from the end where it is negative, to from 0."""
    number = int(token)
    index = number - 1 if number > 0 else count + number
    if not 0 <= index < count or number == 0:
        raise ValueError(f"{label} {number}, and so far there are {count}")
    return index


def read_mtl(path: Path) -> dict[str, Material]:
    """The materials in the MTL file at `path`, by name; lines that make no sense are skipped."""
    materials: dict[str, Material] = {}
    name = None
    for line in decode_text(path.read_bytes()).splitlines():
        key, _, rest = line.strip().partition(" ")
        if key.lower() == "newmtl":
            name = rest.strip()
            materials[name] = Material(None, None)
        elif key.lower() == "kd" and name is not None:
            materials[name] = Material(_parse_color(rest), materials[name].image_path)
        elif key.lower() == "map_kd" and name is not None:
            materials[name] = Material(materials[name].albedo, resolve_sidecar(path, rest))
    return materials


def _parse_color(text: str) -> Float64[np.ndarray, "3"] | None:
    try:
        return srgb_to_linear(np.array([float(token) for token in text.split()[:3]]).reshape(3))
    except ValueError:
        return None
