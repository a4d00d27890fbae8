"""3MF: the build items, and what they are composed of, with colors and production paths.

Not through trimesh, which reads no colors and passes over a build item that is not there
(benchmarks/readers.md).
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.io.readers.archive import parse_xml, read_archive
from industnerf.parts.io.readers.colors import parse_hex
from industnerf.parts.io.readers.mesh_content import (
    MeshBody,
    MeshContent,
    normalize_unit,
    require_valid_indices,
    transform_body,
    unstated_albedo,
)

MM_PER_UNIT = {
    "micron": 1e-3,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "meter": 1000.0,
    "inch": 25.4,
    "foot": 304.8,
}
MAX_PLACEMENTS = 100_000  # places of objects: components of components multiply
SKIPPED_TYPES = ("support", "solidsupport", "surface")
COLOR_GROUPS = {"basematerials": ("base", "displaycolor"), "colorgroup": ("color", "color")}
OTHER_GROUPS = ("texture2dgroup", "compositematerials", "multiproperties")


@dataclass(frozen=True)
class _ThreemfObject:
    """An object of one model file: a mesh, or components."""

    kind: str
    body: MeshBody | None
    components: tuple[tuple[str, str, np.ndarray], ...]  # file, id, where


@dataclass(frozen=True)
class ColorGroups:
    """The color groups of one model file by id, and the ids of other groups."""

    colors: dict[str, Float64[np.ndarray, "k 3"]]
    other_ids: frozenset[str]

    @staticmethod
    def from_model(model: Any) -> "ColorGroups":
        """The groups among the resources of `model`."""
        colors, other_ids = {}, set()
        for node in model.iterfind("{*}resources/*"):
            tag = str(node.tag).rpartition("}")[2]
            if tag in COLOR_GROUPS:
                child, attribute = COLOR_GROUPS[tag]
                parsed = [parse_hex(c.get(attribute, "")) for c in node.iterfind(f"{{*}}{child}")]
                rows = [unstated_albedo(1)[0] if color is None else color for color in parsed]
                colors[node.get("id", "")] = np.array(rows).reshape(-1, 3)
            elif tag in OTHER_GROUPS:
                other_ids.add(node.get("id", ""))
        return ColorGroups(colors, frozenset(other_ids))

    def albedo(
        self, triangles: list[Any], pid: str | None, pindex: str | None
    ) -> tuple[Float64[np.ndarray, "m 3"], list[str]]:
        """Of each triangle the mean of its corners' colors, and what could not be kept.

        `pid` and `pindex` are the object's own, for triangles that name none.
        """
        albedo, cache, unresolved = unstated_albedo(len(triangles)), {}, set()
        for row, triangle in enumerate(triangles):
            group = triangle.get("pid", pid)
            if group is None:
                continue
            first = triangle.get("p1", pindex)
            key = (group, first, triangle.get("p2", first), triangle.get("p3", first))
            if key not in cache:
                cache[key] = self._mean(key[0], key[1:])
            if cache[key] is None:
                unresolved.add(group)
            else:
                albedo[row] = cache[key]
        kinds = {
            "pictures or blends" if group in self.other_ids else "colors" for group in unresolved
        }
        return albedo, [f"{kind} that cannot be resolved are left out" for kind in sorted(kinds)]

    def _mean(self, group: str, corners: tuple[str | None, ...]) -> Float64[np.ndarray, "3"] | None:
        try:
            indices = [int(corner) for corner in corners if corner is not None]
            table = self.colors[group]
            if not indices or min(indices) < 0:
                return None
            return table[indices].mean(axis=0)
        except (KeyError, IndexError, ValueError):
            return None


def read_threemf(path: Path) -> MeshContent:
    """Raises BadPart if the archive is torn, or a mesh or the tree of components makes no sense."""
    files = {name.lstrip("/"): data for name, data in read_archive(path).items()}
    models = {
        name: parse_xml(data) for name, data in files.items() if name.lower().endswith(".model")
    }
    root = next((n for n in models if n.lower() == "3d/3dmodel.model"), next(iter(models), None))
    if root is None:
        raise BadPart("3MF: the archive holds no model")
    unit = models[root].get("unit", "millimeter")
    if unit not in MM_PER_UNIT:
        raise BadPart(f"3MF: unit {unit!r} is none of {', '.join(MM_PER_UNIT)}")
    warnings: list[str] = []
    objects = {k: o for name, model in models.items() for k, o in _objects(name, model, warnings)}
    bodies: list[MeshBody] = []
    for item in models[root].iterfind("{*}build/{*}item"):
        _collect(objects, _target(root, item), _matrix(item), (), bodies)
    kinds = {o.kind for o in objects.values()} & set(SKIPPED_TYPES)
    warnings += [f"objects of type {kind!r} left out" for kind in sorted(kinds)]
    return MeshContent(
        tuple(bodies),
        MM_PER_UNIT[unit],
        normalize_unit(unit),
        False,
        tuple(dict.fromkeys(warnings)),
    )


def _objects(
    name: str, model: Any, warnings: list[str]
) -> list[tuple[tuple[str, str], _ThreemfObject]]:
    groups = ColorGroups.from_model(model)
    objects = []
    for node in model.iterfind("{*}resources/{*}object"):
        mesh = node.find("{*}mesh")
        body = None if mesh is None else _body(node, mesh, groups, warnings)
        parts = tuple(
            (*_target(name, part), _matrix(part)) for part in node.iterfind(".//{*}component")
        )
        objects.append(
            ((name, node.get("id", "")), _ThreemfObject(node.get("type", "model"), body, parts))
        )
    return objects


def _body(node: Any, mesh: Any, groups: ColorGroups, warnings: list[str]) -> MeshBody:
    name = node.get("name") or f"object {node.get('id')}"
    triangles = list(mesh.iterfind("{*}triangles/{*}triangle"))
    try:
        vertex_nodes = mesh.iterfind("{*}vertices/{*}vertex")
        vertices = np.array(
            [(v.get("x"), v.get("y"), v.get("z")) for v in vertex_nodes], np.float64
        )
        faces = np.array([(t.get("v1"), t.get("v2"), t.get("v3")) for t in triangles], np.int64)
    except (TypeError, ValueError, OverflowError) as error:
        raise BadPart(
            f"3MF: object {name!r} has a coordinate or corner that is none: {error}"
        ) from None
    vertices, faces = vertices.reshape(-1, 3), faces.reshape(-1, 3)
    require_valid_indices(faces, len(vertices), f"3MF: object {name!r}")
    albedo, new_warnings = groups.albedo(triangles, node.get("pid"), node.get("pindex"))
    warnings += new_warnings
    return MeshBody(name, vertices, faces, albedo)


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
    objects: dict[tuple[str, str], _ThreemfObject],
    key: tuple[str, str],
    matrix: np.ndarray,
    ancestors: tuple[tuple[str, str], ...],
    bodies: list[MeshBody],
) -> None:
    """Append every mesh at or below the object `key`, placed."""
    if key not in objects:
        raise BadPart(f"3MF: object {key[1]!r} is built, but not there")
    if key in ancestors or len(bodies) >= MAX_PLACEMENTS:
        raise BadPart(
            f"3MF: object {key[1]!r} holds itself, or there are {MAX_PLACEMENTS} places and more"
        )
    node = objects[key]
    if node.kind in SKIPPED_TYPES:
        return
    if node.body is not None and len(node.body.faces):
        bodies.append(transform_body(node.body, matrix, node.body.name))
    for child_file, child_id, child_matrix in node.components:
        _collect(objects, (child_file, child_id), matrix @ child_matrix, (*ancestors, key), bodies)
