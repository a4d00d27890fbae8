"""COLLADA, plain or zipped, through pycollada: one body per geometry placed in the scene."""

import io
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.reading import texture, up
from industnerf.parts.reading.archive import refuse_entities, unpacked
from industnerf.parts.reading.content import (
    Body,
    Content,
    joined,
    placed,
    require_indices,
    short,
    unpainted,
)
from industnerf.parts.reading.paint import linear
from industnerf.parts.reading.sidecars import named

MM = 1000.0  # in a metre; the asset states how many metres a unit has, one if it is silent


def read_dae(path: Path) -> Content:
    """Raises BadPart if the file is no COLLADA, or a face names a vertex that is not there."""

    def picture(name: str) -> bytes | None:
        beside = named(path, name)
        return beside.read_bytes() if beside is not None else None

    return _content(path.read_bytes(), picture)


def read_zae(path: Path) -> Content:
    """As `read_dae`; pictures come from the archive."""
    files = unpacked(path)
    scenes = [name for name in files if name.lower().endswith(".dae") and "MACOSX" not in name]
    if not scenes:
        raise BadPart("zipped COLLADA: the archive holds no .dae")
    ends = {name.rpartition("/")[2]: data for name, data in files.items()}
    return _content(files[scenes[0]], lambda name: ends.get(name.rpartition("/")[2]))


def _content(data: bytes, picture: Any) -> Content:
    from collada import Collada
    from collada.common import DaeError

    refuse_entities(data)
    scene = Collada(io.BytesIO(data), ignore=[DaeError])
    remarks = [f"skipped, for it is broken: {error}" for error in scene.errors[:3]]
    metres = scene.assetInfo.unitmeter if scene.assetInfo is not None else None
    if scene.scene is None:
        raise BadPart("COLLADA: no scene")
    turn = _turn(scene, remarks)
    bodies = []
    for bound in scene.scene.objects("geometry"):
        body = _body(bound, picture, remarks)
        if body is not None:
            matrix = turn @ np.asarray(bound.matrix, np.float64)
            bodies.append(placed(body, matrix, body.name))
    scale = MM * (1.0 if metres is None else float(metres))
    unit = scene.assetInfo.unitname if scene.assetInfo is not None else None
    return Content(
        tuple(bodies), scale, short(unit or "meter"), True, tuple(dict.fromkeys(remarks))
    )


def _turn(scene: Any, remarks: list[str]) -> Float64[np.ndarray, "4 4"]:
    """What brings the file's own up to z; the standard's silence is Y_UP."""
    stated = (scene.xmlnode.findtext("{*}asset/{*}up_axis") or "Y_UP").strip()
    if stated not in up.COLLADA:
        known = ", ".join(up.COLLADA)
        remarks.append(f"up_axis {stated[:20]!r} is none of {known}; taken for Y_UP")
    return up.COLLADA.get(stated, up.Y_UP)


def _body(bound: Any, picture: Any, remarks: list[str]) -> Body | None:
    from collada.polylist import Polylist
    from collada.triangleset import TriangleSet

    geometry, pieces = bound.original, []
    name = str(geometry.name or geometry.id)
    for primitive in geometry.primitives:
        triangles = primitive.triangleset() if isinstance(primitive, Polylist) else primitive
        if isinstance(triangles, TriangleSet) and triangles.vertex is not None and len(triangles):
            vertices = np.asarray(triangles.vertex, np.float64).reshape(-1, 3)
            faces = np.asarray(triangles.vertex_index, np.int64).reshape(-1, 3)
            require_indices(faces, len(vertices), "COLLADA")
            material = bound.materialnodebysymbol.get(primitive.material)
            albedo = _albedo(triangles, material, picture, remarks)
            pieces.append(Body(name, vertices, faces, albedo))
    return joined(name, pieces) if pieces else None


def _albedo(
    triangles: Any, material: Any, picture: Any, remarks: list[str]
) -> Float64[np.ndarray, "m 3"]:
    """Of each triangle: the picture's, else the diffuse colour."""
    albedo = unpainted(len(triangles))
    diffuse = material.target.effect.diffuse if material is not None else None
    if isinstance(diffuse, tuple | list | np.ndarray):
        albedo[:] = linear(np.array(diffuse[:3], np.float64))
    elif diffuse is not None:
        data = picture(str(diffuse.sampler.surface.image.path))
        sets = triangles.texcoordset
        found = None
        if data is not None and len(sets):
            uvs = np.asarray(sets[0])[np.asarray(triangles.texcoord_indexset[0])][..., :2]
            found = texture.sampled(data, uvs.reshape(-1, 3, 2))
        remarks.append(texture.UNREADABLE if found is None else texture.REMARK)
        return albedo if found is None else found
    return albedo
