"""3MF: the build items, and what they are composed of, with colours and production paths."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.reading.archive import unpacked, xml
from industnerf.parts.reading.content import Body, Content, placed, require_indices, short
from industnerf.parts.reading.threemf_paint import Groups

MM = {
    "micron": 1e-3,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "meter": 1000.0,
    "inch": 25.4,
    "foot": 304.8,
}
MOST = 100_000  # places of objects: components of components multiply
NOT_PARTS = ("support", "solidsupport", "surface")


@dataclass(frozen=True)
class _Object:
    """An object of one model file: a mesh, or components."""

    kind: str
    body: Body | None
    components: tuple[tuple[str, str, np.ndarray], ...]  # file, id, where


def read_threemf(path: Path) -> Content:
    """Raises BadPart if the archive is torn, or a mesh or the tree of components makes no sense."""
    files = {name.lstrip("/"): data for name, data in unpacked(path).items()}
    models = {name: xml(data) for name, data in files.items() if name.lower().endswith(".model")}
    root = next((n for n in models if n.lower() == "3d/3dmodel.model"), next(iter(models), None))
    if root is None:
        raise BadPart("3MF: the archive holds no model")
    unit = models[root].get("unit", "millimeter")
    if unit not in MM:
        raise BadPart(f"3MF: unit {unit!r} is none of {', '.join(MM)}")
    remarks: list[str] = []
    objects = {k: o for name, model in models.items() for k, o in _objects(name, model, remarks)}
    bodies: list[Body] = []
    for item in models[root].iterfind("{*}build/{*}item"):
        _collect(objects, _target(root, item), _matrix(item), (), bodies)
    kinds = {o.kind for o in objects.values()} & set(NOT_PARTS)
    remarks += [f"objects of type {kind!r} left out" for kind in sorted(kinds)]
    return Content(tuple(bodies), MM[unit], short(unit), False, tuple(dict.fromkeys(remarks)))


def _objects(name: str, model: Any, remarks: list[str]) -> list[tuple[tuple[str, str], _Object]]:
    groups = Groups.of(model)
    found = []
    for node in model.iterfind("{*}resources/{*}object"):
        mesh = node.find("{*}mesh")
        body = None if mesh is None else _body(node, mesh, groups, remarks)
        parts = tuple(
            (*_target(name, part), _matrix(part)) for part in node.iterfind(".//{*}component")
        )
        found.append(((name, node.get("id", "")), _Object(node.get("type", "model"), body, parts)))
    return found


def _body(node: Any, mesh: Any, groups: Groups, remarks: list[str]) -> Body:
    name = node.get("name") or f"object {node.get('id')}"
    triangles = list(mesh.iterfind("{*}triangles/{*}triangle"))
    try:
        places = mesh.iterfind("{*}vertices/{*}vertex")
        vertices = np.array([(v.get("x"), v.get("y"), v.get("z")) for v in places], np.float64)
        faces = np.array([(t.get("v1"), t.get("v2"), t.get("v3")) for t in triangles], np.int64)
    except (TypeError, ValueError, OverflowError) as error:
        raise BadPart(
            f"3MF: object {name!r} has a coordinate or corner that is none: {error}"
        ) from None
    vertices, faces = vertices.reshape(-1, 3), faces.reshape(-1, 3)
    require_indices(faces, len(vertices), f"3MF: object {name!r}")
    albedo, remark = groups.albedo(triangles, node.get("pid"), node.get("pindex"))
    remarks += remark
    return Body(name, vertices, faces, albedo)


def _target(name: str, node: Any) -> tuple[str, str]:
    """Model file and id that an item or a component names; the production extension adds a path."""
    paths = [value for key, value in node.attrib.items() if key.rpartition("}")[2] == "path"]
    return (paths[0].lstrip("/") if paths else name), node.get("objectid", "")


def _matrix(node: Any) -> Float64[np.ndarray, "4 4"]:
    """The transform of an item: 12 numbers, columns of the affine map."""
    text = node.get("transform")
    matrix = np.eye(4)
    if text is not None:
        try:
            matrix[:3] = np.array(text.split(), np.float64).reshape(4, 3).T
        except ValueError:
            raise BadPart(f"3MF: the transform {text[:60]!r} is not 12 numbers") from None
    return matrix


def _collect(
    objects: dict[tuple[str, str], _Object],
    key: tuple[str, str],
    matrix: np.ndarray,
    above: tuple[tuple[str, str], ...],
    bodies: list[Body],
) -> None:
    """Append every mesh at or below the object `key`, placed."""
    if key not in objects:
        raise BadPart(f"3MF: object {key[1]!r} is built, but not there")
    if key in above or len(bodies) >= MOST:
        raise BadPart(f"3MF: object {key[1]!r} holds itself, or there are {MOST} places and more")
    found = objects[key]
    if found.kind in NOT_PARTS:
        return
    if found.body is not None and len(found.body.faces):
        bodies.append(placed(found.body, matrix, found.body.name))
    for file, part, where in found.components:
        _collect(objects, (file, part), matrix @ where, (*above, key), bodies)
