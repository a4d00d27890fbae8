"""PLY through trimesh, once its header has been held against the size of the file."""

from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.reading.content import Body, Content, require_indices, unpainted
from industnerf.parts.reading.paint import linear

BYTES = {"1": ("char", "uchar", "int8", "uint8"), "2": ("short", "ushort", "int16", "uint16")}
BYTES |= {"4": ("int", "uint", "float", "int32", "uint32", "float32")}
BYTES |= {"8": ("double", "float64", "int64", "uint64")}
SIZE = {name: int(size) for size, names in BYTES.items() for name in names}
END = b"end_header"


def read_ply(path: Path) -> Content:
    """Raises BadPart if the file is shorter than its header promises, or holds no face."""
    import trimesh

    header, rest = _header(path.read_bytes())
    _require_room(header, rest)
    with path.open("rb") as file:
        loaded = trimesh.load_scene(
            file, file_type="ply", process=False, skip_materials=True, fix_texture=False
        )
    meshes = [m for m in loaded.geometry.values() if isinstance(m, trimesh.Trimesh)]
    remarks = [
        f"its picture is left out: {line.split()[-1]}" for line in header if "TextureFile" in line
    ]
    single = not any(line.split()[1:2] in (["double"], ["float64"]) for line in header)
    bodies = tuple(_body(f"solid {i}", mesh) for i, mesh in enumerate(meshes, start=1))
    return Content(bodies, None, None, single, tuple(remarks))


def _header(data: bytes) -> tuple[list[str], int]:
    """The lines of the header, and the number of bytes behind it."""
    end = data.find(END)
    if end < 0:
        raise BadPart("PLY: its header has no end")
    lines = data[:end].decode("ascii", errors="replace").splitlines()
    return lines, len(data) - end - len(END)


def _require_room(header: list[str], held: int) -> None:
    """Raise BadPart unless `held` bytes can hold all rows that the header promises."""
    text = any(line.split()[:2] == ["format", "ascii"] for line in header)
    rows, needed, promised = 0, 0, []
    for words in (line.split() for line in header):
        if words[:1] == ["element"]:
            rows = int(words[2]) if words[2:] and words[2].isdigit() else -1
            if rows < 0:
                raise BadPart(f"PLY: {' '.join(words)[:60]!r} is no count")
            promised.append(f"{rows} {words[1]} rows")
        elif words[:1] == ["property"] and len(words) > 2:
            kind = words[2] if words[1] == "list" else words[1]
            needed += rows * (2 if text else SIZE.get(kind, 1))
    if needed > held + 2:
        raise BadPart(
            f"PLY: header promises {' and '.join(promised)}, at least {needed} bytes; the file "
            f"holds {held}: it is cut short"
        )


def _body(name: str, mesh: object) -> Body:
    faces = np.asarray(mesh.faces, np.int64)
    vertices = np.asarray(mesh.vertices, np.float64)
    require_indices(faces, len(vertices), "PLY")
    return Body(name, vertices, faces, painted(mesh))


def painted(mesh: object) -> Float64[np.ndarray, "m 3"]:
    """The albedo of the faces of a trimesh mesh, from its faces or the mean of their corners."""
    faces = np.asarray(mesh.faces)
    if mesh.visual.kind == "face":
        return linear(np.asarray(mesh.visual.face_colors)[:, :3] / 255)
    if mesh.visual.kind == "vertex":
        return linear(np.asarray(mesh.visual.vertex_colors)[:, :3] / 255)[faces].mean(axis=1)
    return unpainted(len(faces))
