"""PLY through trimesh, once its header has been held against the size of the file."""

from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.io.readers.colors import srgb_to_linear
from industnerf.parts.io.readers.mesh_content import (
    MeshBody,
    MeshContent,
    require_valid_indices,
    unstated_albedo,
)

TYPES_OF_SIZE = {
    "1": ("char", "uchar", "int8", "uint8"),
    "2": ("short", "ushort", "int16", "uint16"),
}
TYPES_OF_SIZE |= {"4": ("int", "uint", "float", "int32", "uint32", "float32")}
TYPES_OF_SIZE |= {"8": ("double", "float64", "int64", "uint64")}
TYPE_BYTES = {name: int(size) for size, names in TYPES_OF_SIZE.items() for name in names}
HEADER_END = b"end_header"


def read_ply(path: Path) -> MeshContent:
    """Raises BadPart if the file is shorter than its header promises, or holds no face."""
    import trimesh

    header, num_bytes = _read_header(path.read_bytes())
    _require_size(header, num_bytes)
    rows = {line.split()[1]: int(line.split()[2]) for line in header if line.startswith("element ")}
    if not any(count for name, count in rows.items() if name != "vertex"):
        return MeshContent((), None, None, False, num_points=rows.get("vertex", 0))
    with path.open("rb") as file:
        loaded = trimesh.load_scene(
            file, file_type="ply", process=False, skip_materials=True, fix_texture=False
        )
    meshes = [m for m in loaded.geometry.values() if isinstance(m, trimesh.Trimesh)]
    warnings = [
        f"its picture is left out: {line.split()[-1]}" for line in header if "TextureFile" in line
    ]
    is_float32 = not any(line.split()[1:2] in (["double"], ["float64"]) for line in header)
    bodies = tuple(_body(f"solid {i}", mesh) for i, mesh in enumerate(meshes, start=1))
    return MeshContent(bodies, None, None, is_float32, tuple(warnings))


def _read_header(data: bytes) -> tuple[list[str], int]:
    """The lines of the header, and the number of bytes behind it."""
    end = data.find(HEADER_END)
    if end < 0:
        raise BadPart("PLY: its header has no end")
    lines = data[:end].decode("ascii", errors="replace").splitlines()
    return lines, len(data) - end - len(HEADER_END)


def _require_size(header: list[str], available: int) -> None:
    """Raise BadPart unless `available` bytes can hold all rows that the header promises."""
    is_text = any(line.split()[:2] == ["format", "ascii"] for line in header)
    rows, needed, declared = 0, 0, []
    for tokens in (line.split() for line in header):
        if tokens[:1] == ["element"]:
            rows = int(tokens[2]) if tokens[2:] and tokens[2].isdigit() else -1
            if rows < 0:
                raise BadPart(f"PLY: {' '.join(tokens)[:60]!r} is no count")
            declared.append(f"{rows} {tokens[1]} rows")
        elif tokens[:1] == ["property"] and len(tokens) > 2:
            kind = tokens[2] if tokens[1] == "list" else tokens[1]
            needed += rows * (2 if is_text else TYPE_BYTES.get(kind, 1))
    if needed > available + 2:
        raise BadPart(
            f"PLY: header promises {' and '.join(declared)}, at least {needed} bytes; the file "
            f"holds {available}: it is cut short"
        )


def _body(name: str, mesh: object) -> MeshBody:
    faces = np.asarray(mesh.faces, np.int64)
    vertices = np.asarray(mesh.vertices, np.float64)
    require_valid_indices(faces, len(vertices), "PLY")
    return MeshBody(name, vertices, faces, face_albedo(mesh))


def face_albedo(mesh: object) -> Float64[np.ndarray, "m 3"]:
    """The albedo of the faces of a trimesh mesh, from its faces or the mean of their corners."""
    faces = np.asarray(mesh.faces)
    if mesh.visual.kind == "face":
        return srgb_to_linear(np.asarray(mesh.visual.face_colors)[:, :3] / 255)
    if mesh.visual.kind == "vertex":
        return srgb_to_linear(np.asarray(mesh.visual.vertex_colors)[:, :3] / 255)[faces].mean(
            axis=1
        )
    return unstated_albedo(len(faces))
