"""COLLADA, plain or zipped, through pycollada: one body per geometry placed in the scene."""

import io
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.io.readers.archive import read_archive, reject_entities
from industnerf.parts.io.readers.colors import (
    TEXTURE_REDUCED,
    TEXTURE_UNREADABLE,
    sample_texture,
    srgb_to_linear,
)
from industnerf.parts.io.readers.mesh_content import (
    X_UP,
    Y_UP,
    Z_UP,
    MeshBody,
    MeshContent,
    concatenate_bodies,
    normalize_unit,
    require_valid_indices,
    transform_body,
    unstated_albedo,
)
from industnerf.parts.io.readers.sidecars import resolve_sidecar

MM_PER_METER = 1000.0
UP_AXES = {"X_UP": X_UP, "Y_UP": Y_UP, "Z_UP": Z_UP}


def read_dae(path: Path) -> MeshContent:
    """Raises BadPart if the file is no COLLADA, or a face names a vertex that is not there."""

    def load_image(name: str) -> bytes | None:
        sidecar = resolve_sidecar(path, name)
        return sidecar.read_bytes() if sidecar is not None else None

    return _read_content(path.read_bytes(), load_image)


def read_zae(path: Path) -> MeshContent:
    """As `read_dae`; pictures come from the archive."""
    files = read_archive(path)
    scene_names = [name for name in files if name.lower().endswith(".dae") and "MACOSX" not in name]
    if not scene_names:
        raise BadPart("zipped COLLADA: the archive holds no .dae")
    by_basename = {name.rpartition("/")[2]: data for name, data in files.items()}
    return _read_content(
        files[scene_names[0]], lambda name: by_basename.get(name.rpartition("/")[2])
    )


def _read_content(data: bytes, load_image: Any) -> MeshContent:
    from collada import Collada
    from collada.common import DaeError

    reject_entities(data)
    scene = Collada(io.BytesIO(data), ignore=[DaeError])
    warnings = [f"skipped, for it is broken: {error}" for error in scene.errors[:3]]
    unit_meters = scene.assetInfo.unitmeter if scene.assetInfo is not None else None
    if scene.scene is None:
        raise BadPart("COLLADA: no scene")
    to_z_up = _up_transform(scene, warnings)
    bodies = []
    for geometry in scene.scene.objects("geometry"):
        body = _body(geometry, load_image, warnings)
        if body is not None:
            matrix = to_z_up @ np.asarray(geometry.matrix, np.float64)
            bodies.append(transform_body(body, matrix, body.name))
    scale = MM_PER_METER * (1.0 if unit_meters is None else float(unit_meters))
    unit = scene.assetInfo.unitname if scene.assetInfo is not None else None
    return MeshContent(
        tuple(bodies), scale, normalize_unit(unit or "meter"), True, tuple(dict.fromkeys(warnings))
    )


def _up_transform(scene: Any, warnings: list[str]) -> Float64[np.ndarray, "4 4"]:
    """What brings the file's own up to z; the standard's silence is Y_UP."""
    stated = (scene.xmlnode.findtext("{*}asset/{*}up_axis") or "Y_UP").strip()
    if stated not in UP_AXES:
        axes = ", ".join(UP_AXES)
        warnings.append(f"up_axis {stated[:20]!r} is none of {axes}; taken for Y_UP")
    return UP_AXES.get(stated, Y_UP)


def _body(bound: Any, load_image: Any, warnings: list[str]) -> MeshBody | None:
    from collada.polylist import Polylist
    from collada.triangleset import TriangleSet

    geometry, pieces = bound.original, []
    name = str(geometry.name or geometry.id)
    for primitive in geometry.primitives:
        triangles = primitive.triangleset() if isinstance(primitive, Polylist) else primitive
        if isinstance(triangles, TriangleSet) and triangles.vertex is not None and len(triangles):
            vertices = np.asarray(triangles.vertex, np.float64).reshape(-1, 3)
            faces = np.asarray(triangles.vertex_index, np.int64).reshape(-1, 3)
            require_valid_indices(faces, len(vertices), "COLLADA")
            material = bound.materialnodebysymbol.get(primitive.material)
            albedo = _albedo(triangles, material, load_image, warnings)
            pieces.append(MeshBody(name, vertices, faces, albedo))
    return concatenate_bodies(name, pieces) if pieces else None


def _albedo(
    triangles: Any, material: Any, load_image: Any, warnings: list[str]
) -> Float64[np.ndarray, "m 3"]:
    """Of each triangle: the picture's, else the diffuse color."""
    albedo = unstated_albedo(len(triangles))
    diffuse = material.target.effect.diffuse if material is not None else None
    if isinstance(diffuse, tuple | list | np.ndarray):
        albedo[:] = srgb_to_linear(np.array(diffuse[:3], np.float64))
    elif diffuse is not None:
        data = load_image(str(diffuse.sampler.surface.image.path))
        uv_sets = triangles.texcoordset
        sampled = None
        if data is not None and len(uv_sets):
            uvs = np.asarray(uv_sets[0])[np.asarray(triangles.texcoord_indexset[0])][..., :2]
            sampled = sample_texture(data, uvs.reshape(-1, 3, 2))
        warnings.append(TEXTURE_UNREADABLE if sampled is None else TEXTURE_REDUCED)
        return albedo if sampled is None else sampled
    return albedo
