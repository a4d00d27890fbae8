"""3DXML of the CATIA family: one body per place in the assembly.  It states no unit.

Not through trimesh, which repeats triangles where a surface has several faces, makes unstated
colors gray and needs normals (benchmarks/readers.md).
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.errors import BadPart
from industnerf.parts.io.readers.archive import parse_xml, read_archive
from industnerf.parts.io.readers.colors import srgb_to_linear
from industnerf.parts.io.readers.mesh_content import (
    MeshBody,
    MeshContent,
    concatenate_bodies,
    fan_triangles,
    require_valid_indices,
    strip_triangles,
    transform_body,
    unstated_albedo,
)

MAX_PLACEMENTS = 100_000  # places of parts: assemblies of assemblies multiply
Albedo = Float64[np.ndarray, "3"]


def read_threedxml(path: Path) -> MeshContent:
    """Raises BadPart if the archive is torn, or the assembly or a surface makes no sense."""
    files = read_archive(path)
    manifest = parse_xml(_read_member(files, "Manifest.xml"))
    tree = parse_xml(_read_member(files, manifest.findtext("{*}Root") or ""))
    materials = _read_materials(files)
    shapes: dict[str, MeshBody | None] = {}
    for node in tree.iter("{*}ReferenceRep"):
        if node.get("format") == "TESSELLATED":
            pieces = read_representation(
                parse_xml(_read_member(files, node.get("associatedFile", ""))), materials
            )
            shapes[node.get("id")] = concatenate_bodies("", pieces) if pieces else None
    num_skipped = sum(node.get("format") != "TESSELLATED" for node in tree.iter("{*}ReferenceRep"))
    warnings = (f"shapes without triangles left out: {num_skipped}",) if num_skipped else ()
    root = tree.find("{*}ProductStructure")
    if root is None:
        raise BadPart("3DXML: no product structure")
    bodies = tuple(_iter_bodies(tree, root.get("root", ""), shapes))
    return MeshContent(bodies, None, None, False, warnings)


def _read_member(files: dict[str, bytes], name: str) -> bytes:
    name = name.rpartition(":")[2]
    if name not in files:
        raise BadPart(f"3DXML: {name!r}, which it names, is not in the archive")
    return files[name]


def _iter_bodies(tree: Any, root: str, shapes: dict[str, MeshBody | None]) -> Iterator[MeshBody]:
    """Every shape wherever it stands, found from the root down."""
    names = {node.get("id"): node.get("name") for node in tree.iter("{*}Reference3D")}
    children_of: dict[str | None, list[tuple[str | None, np.ndarray]]] = {}
    for node in [*tree.iter("{*}Instance3D"), *tree.iter("{*}InstanceRep")]:
        child = (node.findtext("{*}IsInstanceOf"), _matrix(node.findtext("{*}RelativeMatrix")))
        children_of.setdefault(node.findtext("{*}IsAggregatedBy"), []).append(child)
    stack: list[tuple[str | None, np.ndarray, tuple]] = [(root, np.eye(4), ())]
    num_visited = 0
    while stack:
        index, matrix, ancestors = stack.pop()
        shape = shapes.get(index)
        if shape is not None:
            yield transform_body(
                shape, matrix, names.get(ancestors[-1] if ancestors else None) or "solid"
            )
        num_visited += 1
        if index in ancestors or num_visited > MAX_PLACEMENTS:
            raise BadPart(
                f"3DXML: {index} holds itself, or there are {MAX_PLACEMENTS} places and more"
            )
        children = children_of.get(index, [])
        stack += [
            (child, matrix @ child_matrix, (*ancestors, index))
            for child, child_matrix in reversed(children)
        ]


def _matrix(text: str | None) -> Float64[np.ndarray, "4 4"]:
    """12 numbers: the columns of the rotation, then the shift."""
    matrix = np.eye(4)
    if text:
        numbers = np.array(text.split(), np.float64).reshape(4, 3)
        matrix[:3] = numbers.T
    return matrix


def _read_materials(files: dict[str, bytes]) -> dict[str, Float64[np.ndarray, "3"]]:
    """The diffuse colors of the library of materials, by every id that may stand for one."""
    albedos: dict[str, Float64[np.ndarray, "3"]] = {}
    if "CATMaterialRef.3dxml" not in files:
        return albedos
    library = parse_xml(files["CATMaterialRef.3dxml"])
    for domain in library.iter("{*}MaterialDomain"):
        material_xml = parse_xml(_read_member(files, domain.get("associatedFile", "")))
        for attribute in material_xml.iterfind(".//{*}Attr[@Name='DiffuseColor']"):
            albedos[domain.get("id")] = srgb_to_linear(
                np.array(json.loads(attribute.get("Value"))[:3], float)
            )
    for instance in library.iter("{*}MaterialDomainInstance"):
        material = albedos.get(instance.findtext("{*}IsInstanceOf"))
        for owner in instance.iterfind("{*}IsAggregatedBy"):
            if material is not None:
                albedos[owner.text] = material
    return albedos


def read_representation(root: Any, materials: dict[str, Albedo]) -> list[MeshBody]:
    """The pieces of one shape; coarser copies of them for far views are passed over."""
    return [
        piece
        for node in root.iter("{*}Rep")
        if (positions := node.find("{*}VertexBuffer/{*}Positions")) is not None
        if (piece := _piece(node, positions.text or "", materials)) is not None
    ]


def _piece(node: Any, positions: str, materials: dict[str, Albedo]) -> MeshBody | None:
    vertices = np.array(positions.replace(",", " ").split(), np.float64).reshape(-1, 3)
    piece_albedo = _find_albedo(node, materials, unstated_albedo(1)[0])
    corners, albedo = [], []
    for group in node.iterfind("{*}Faces"):
        group_albedo = _find_albedo(group, materials, piece_albedo)
        for face in group.iterfind("{*}Face"):
            triangles = _triangles(face)
            corners.append(triangles)
            face_albedo = _find_albedo(face, materials, group_albedo)
            albedo.append(np.broadcast_to(face_albedo, (len(triangles), 3)))
    if not corners:
        return None
    faces = np.concatenate(corners)
    require_valid_indices(faces, len(vertices), "3DXML")
    return MeshBody("", vertices, faces, np.concatenate(albedo))


def _triangles(face: Any) -> Int64[np.ndarray, "m 3"]:
    groups = [np.array(face.get("triangles", "").split(), np.int64).reshape(-1, 3)]
    for key, triangles in (("strips", strip_triangles), ("fans", fan_triangles)):
        for text in face.get(key, "").split(","):
            groups.append(triangles(np.array(text.split(), np.int64)))
    return np.concatenate(groups)


def _find_albedo(node: Any, materials: dict[str, Albedo], default: Albedo) -> Albedo:
    """The color or the material at `node`; `default` if it states none."""
    color = node.find("{*}SurfaceAttributes/{*}Color")
    if color is not None:
        channels = [float(color.get(name, 1)) for name in ("red", "green", "blue")]
        return srgb_to_linear(np.array(channels))
    material = node.find("{*}SurfaceAttributes/{*}MaterialApplication/{*}MaterialId")
    if material is not None:
        return materials.get(material.get("id", "").rpartition("#")[2], default)
    return default
