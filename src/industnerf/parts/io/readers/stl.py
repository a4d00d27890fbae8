"""STL, binary and text.  It states neither units nor colors.

Not through trimesh, which refuses decimal commas and bytes after the last triangle, and answers a
file that is cut short with an empty scene (benchmarks/readers.md).
"""

import re
from pathlib import Path

import numpy as np

from industnerf.errors import BadPart
from industnerf.parts.io.readers.formats import decode_text, is_binary_stl
from industnerf.parts.io.readers.mesh_content import MeshBody, MeshContent, unstated_albedo

HEADER_BYTES, RECORD_BYTES = 84, 50  # bytes
SOLID_PATTERN = re.compile(
    r"^[ \t]*solid\b([^\n]*)\n(.*?)(?=^[ \t]*endsolid|^[ \t]*solid\b|\Z)", re.M | re.S | re.I
)
VERTEX_PATTERN = re.compile(r"\bvertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.I)


def read_stl(path: Path) -> tuple[str, MeshContent]:
    """Which of the two it is, and the triangles; raises BadPart that says what is the matter."""
    data = path.read_bytes()
    if is_binary_stl(data, len(data)):
        return "binary STL", _binary(data, ())
    if re.match(r"\s*solid\b", decode_text(data[:1024]), re.I) and b"\0" not in data[:HEADER_BYTES]:
        return "text STL", _text(decode_text(data).replace("\r\n", "\n").replace("\r", "\n"))
    return "binary STL", _binary(*_trim_binary(data))


def _trim_binary(data: bytes) -> tuple[bytes, tuple[str, ...]]:
    """A binary STL whose size is not what its header says: cut short, or with a tail."""
    if b"\0" not in data:
        raise BadPart("no STL: neither `solid` and `facet` in text, nor a binary header")
    if len(data) < HEADER_BYTES:
        raise BadPart(f"binary STL: {len(data)} bytes, and the header alone has {HEADER_BYTES}")
    declared = int.from_bytes(data[80:HEADER_BYTES], "little")
    available, tail = divmod(len(data) - HEADER_BYTES, RECORD_BYTES)
    if declared > available:
        raise BadPart(
            f"binary STL: header promises {declared} triangles, the file holds {available}: it is "
            "cut short"
        )
    tail += (available - declared) * RECORD_BYTES
    return data[: HEADER_BYTES + declared * RECORD_BYTES], (
        f"{tail} bytes after the last triangle ignored",
    )


def _binary(data: bytes, warnings: tuple[str, ...]) -> MeshContent:
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.frombuffer(data, record, offset=HEADER_BYTES)["corners"]
    return MeshContent((_body("solid 1", corners.reshape(-1, 3)),), None, None, True, warnings)


def _text(text: str) -> MeshContent:
    warnings = []
    bodies = []
    for name, facets in SOLID_PATTERN.findall(text):
        rows = VERTEX_PATTERN.findall(facets)
        if len(rows) % 3:
            raise BadPart(
                f"text STL: solid {name.strip()!r} has {len(rows)} vertices, not 3 a face"
            )
        has_commas = any("," in token for token in rows[0]) if rows else False
        if has_commas:
            rows = [tuple(token.replace(",", ".") for token in row) for row in rows]
            warnings.append("decimal commas read as points")
        if rows:
            bodies.append(_body(name.strip() or f"solid {len(bodies) + 1}", _parse_vertices(rows)))
    if "endsolid" not in text[-4096:].lower():
        warnings.append("the text does not end with `endsolid`: it may be cut short")
    return MeshContent(tuple(bodies), None, None, False, tuple(dict.fromkeys(warnings)))


def _parse_vertices(rows: list[tuple[str, ...]]) -> np.ndarray:
    try:
        return np.array(rows).astype(np.float64)
    except ValueError as error:
        raise BadPart(f"text STL: a vertex is no number: {error}") from None


def _body(name: str, corners: np.ndarray) -> MeshBody:
    count = len(corners) // 3
    faces = np.arange(3 * count, dtype=np.int64).reshape(-1, 3)
    return MeshBody(name, corners.astype(np.float64), faces, unstated_albedo(count))
