"""Wavefront OBJ: one body per `o`; groups are not bodies, for many programs write one per face."""

from itertools import chain
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.parts.io.readers import texture
from industnerf.parts.io.readers.colors import srgb_to_linear
from industnerf.parts.io.readers.mesh_content import MeshBody, MeshContent, unstated_albedo
from industnerf.parts.io.readers.mtl import Material, read_mtl
from industnerf.parts.io.readers.obj_parser import ObjObject, ObjScene, parse_obj
from industnerf.parts.io.readers.sidecars import resolve_sidecar


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
    return MeshContent(tuple(bodies), None, None, False, tuple(dict.fromkeys(warnings)))


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
        sampled = texture.sample_texture(material.image_path.read_bytes(), np.array(scene.uvs)[uvs])
        if sampled is not None:
            warnings.append(texture.REDUCED_WARNING)
            return sampled
        warnings.append(f"picture {material.image_path.name} cannot be read")
    return material.albedo
