"""3DXML of the CATIA family: one body per place in the assembly.  It states no unit.

Read here and not by trimesh, which repeats triangles where a surface has several coloured faces.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.reading.archive import unpacked, xml
from industnerf.parts.reading.content import Body, Content, joined, placed
from industnerf.parts.reading.paint import linear
from industnerf.parts.reading.threedxml_mesh import representation

MOST = 100_000  # places of parts: assemblies of assemblies multiply


def read_threedxml(path: Path) -> Content:
    """Raises BadPart if the archive is torn, or the assembly or a surface makes no sense."""
    files = unpacked(path)
    manifest = xml(_file(files, "Manifest.xml"))
    tree = xml(_file(files, manifest.findtext("{*}Root") or ""))
    materials = _materials(files)
    shapes: dict[str, Body | None] = {}
    for node in tree.iter("{*}ReferenceRep"):
        if node.get("format") == "TESSELLATED":
            pieces = representation(xml(_file(files, node.get("associatedFile", ""))), materials)
            shapes[node.get("id")] = joined("", pieces) if pieces else None
    left_out = sum(node.get("format") != "TESSELLATED" for node in tree.iter("{*}ReferenceRep"))
    remarks = (f"shapes without triangles left out: {left_out}",) if left_out else ()
    root = tree.find("{*}ProductStructure")
    if root is None:
        raise BadPart("3DXML: no product structure")
    bodies = tuple(_places(tree, root.get("root", ""), shapes))
    return Content(bodies, None, None, False, remarks)


def _file(files: dict[str, bytes], name: str) -> bytes:
    name = name.rpartition(":")[2]
    if name not in files:
        raise BadPart(f"3DXML: {name!r}, which it names, is not in the archive")
    return files[name]


def _places(tree: Any, root: str, shapes: dict[str, Body | None]) -> Iterator[Body]:
    """Every shape wherever it stands, found from the root down."""
    names = {node.get("id"): node.get("name") for node in tree.iter("{*}Reference3D")}
    below: dict[str | None, list[tuple[str | None, np.ndarray]]] = {}
    for node in [*tree.iter("{*}Instance3D"), *tree.iter("{*}InstanceRep")]:
        child = (node.findtext("{*}IsInstanceOf"), _matrix(node.findtext("{*}RelativeMatrix")))
        below.setdefault(node.findtext("{*}IsAggregatedBy"), []).append(child)
    todo: list[tuple[str | None, np.ndarray, tuple]] = [(root, np.eye(4), ())]
    found = 0
    while todo:
        index, matrix, above = todo.pop()
        shape = shapes.get(index)
        if shape is not None:
            yield placed(shape, matrix, names.get(above[-1] if above else None) or "solid")
        found += 1
        if index in above or found > MOST:
            raise BadPart(f"3DXML: {index} holds itself, or there are {MOST} places and more")
        children = below.get(index, [])
        todo += [(child, matrix @ where, (*above, index)) for child, where in reversed(children)]


def _matrix(text: str | None) -> Float64[np.ndarray, "4 4"]:
    """12 numbers: the columns of the rotation, then the shift."""
    matrix = np.eye(4)
    if text:
        numbers = np.array(text.split(), np.float64).reshape(4, 3)
        matrix[:3] = numbers.T
    return matrix


def _materials(files: dict[str, bytes]) -> dict[str, Float64[np.ndarray, "3"]]:
    """The diffuse colours of the library of materials, by every id that may stand for one."""
    found: dict[str, Float64[np.ndarray, "3"]] = {}
    if "CATMaterialRef.3dxml" not in files:
        return found
    library = xml(files["CATMaterialRef.3dxml"])
    for domain in library.iter("{*}MaterialDomain"):
        look = xml(_file(files, domain.get("associatedFile", "")))
        for attribute in look.iterfind(".//{*}Attr[@Name='DiffuseColor']"):
            found[domain.get("id")] = linear(
                np.array(json.loads(attribute.get("Value"))[:3], float)
            )
    for instance in library.iter("{*}MaterialDomainInstance"):
        material = found.get(instance.findtext("{*}IsInstanceOf"))
        for owner in instance.iterfind("{*}IsAggregatedBy"):
            if material is not None:
                found[owner.text] = material
    return found
