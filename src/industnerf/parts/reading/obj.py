"""Wavefront OBJ: one body per `o`; groups are not bodies, for many programs write one per face."""

from itertools import chain
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.parts.reading import texture
from industnerf.parts.reading.content import Body, Content, unpainted
from industnerf.parts.reading.mtl import Material, materials
from industnerf.parts.reading.obj_lines import Object, Scene, scene_of
from industnerf.parts.reading.paint import linear
from industnerf.parts.reading.sidecars import named


def read_obj(path: Path) -> Content:
    """Raises BadPart that names the line if a face or a vertex makes no sense."""
    scene = scene_of(path)
    remarks = scene.remarks
    known = _materials(path, scene, remarks)
    solids = [each for each in scene.objects if each.corners]
    points = np.array(scene.points, np.float64).reshape(-1, 3)
    bodies = [
        _body(scene, each, points, known, each.name or f"solid {i}", remarks)
        for i, each in enumerate(solids, start=1)
    ]
    return Content(tuple(bodies), None, None, False, tuple(dict.fromkeys(remarks)))


def _materials(path: Path, scene: Scene, remarks: list[str]) -> dict[str, Material]:
    known: dict[str, Material] = {}
    for text in chain.from_iterable(map(_names, scene.libraries)):
        library = named(path, text)
        if library is None:
            remarks.append(f"its materials are missing: {text[:80]}")
        else:
            known |= materials(library)
    return known


def _names(line: str) -> list[str]:
    """The files that one `mtllib` names, each up to its ending, for names may hold blanks."""
    names = [""]
    for word in line.split():
        names[-1] = f"{names[-1]} {word}".lstrip()
        if word.lower().endswith(".mtl"):
            names.append("")
    return [name for name in names if name] or [line]


def _body(
    scene: Scene,
    each: Object,
    points: Float64[np.ndarray, "n 3"],
    known: dict[str, Material],
    name: str,
    remarks: list[str],
) -> Body:
    faces = np.array(each.corners, np.int64)
    used, inverse = np.unique(faces, return_inverse=True)
    albedo = _vertex_paint(scene, faces)
    own = np.array(each.materials)
    for material in np.unique(own):
        look, mine = known.get(str(material)), own == material
        if look is not None:
            painted = _look(scene, look, np.array(each.uvs, np.int64)[mine], remarks)
            albedo[mine] = albedo[mine] if painted is None else painted
    return Body(name, points[used], inverse.reshape(-1, 3), albedo)


def _vertex_paint(scene: Scene, faces: np.ndarray) -> Float64[np.ndarray, "m 3"]:
    if not scene.colours:
        return unpainted(len(faces))
    table = unpainted(len(scene.points))
    table[list(scene.colours)] = linear(np.array(list(scene.colours.values())))
    return table[faces].mean(axis=1)


def _look(scene: Scene, look: Material, uvs: np.ndarray, remarks: list[str]) -> np.ndarray | None:
    """The albedo of faces of one material, for each or for all; None if it states none."""
    if look.picture is not None and (uvs >= 0).all():
        found = texture.sampled(look.picture.read_bytes(), np.array(scene.uvs)[uvs])
        if found is not None:
            remarks.append(texture.REMARK)
            return found
        remarks.append(f"picture {look.picture.name} cannot be read")
    return look.albedo
