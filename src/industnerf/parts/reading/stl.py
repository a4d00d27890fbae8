"""STL, binary and text.  It knows neither units nor colours."""

import re
from pathlib import Path

import numpy as np

from industnerf.errors import BadPart
from industnerf.parts.reading.content import Body, Content, unpainted
from industnerf.parts.reading.formats import is_binary_stl, text_of

HEADER, RECORD = 84, 50  # bytes
SOLID = re.compile(
    r"^[ \t]*solid\b([^\n]*)\n(.*?)(?=^[ \t]*endsolid|^[ \t]*solid\b|\Z)", re.M | re.S | re.I
)
VERTEX = re.compile(r"\bvertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.I)


def read_stl(path: Path) -> tuple[str, Content]:
    """Which of the two it is, and the triangles; raises BadPart that says what is the matter."""
    data = path.read_bytes()
    if is_binary_stl(data, len(data)):
        return "binary STL", _binary(data, ())
    if re.match(r"\s*solid\b", text_of(data[:1024]), re.I) and b"\0" not in data[:HEADER]:
        return "text STL", _text(text_of(data).replace("\r\n", "\n").replace("\r", "\n"))
    return "binary STL", _binary(*_measured(data))


def _measured(data: bytes) -> tuple[bytes, tuple[str, ...]]:
    """A binary STL whose size is not what its header says: cut short, or with a tail."""
    if b"\0" not in data:
        raise BadPart("no STL: neither `solid` and `facet` in text, nor a binary header")
    if len(data) < HEADER:
        raise BadPart(f"binary STL: {len(data)} bytes, and the header alone has {HEADER}")
    promised = int.from_bytes(data[80:HEADER], "little")
    held, tail = divmod(len(data) - HEADER, RECORD)
    if promised > held:
        raise BadPart(
            f"binary STL: header promises {promised} triangles, the file holds {held}: it is cut "
            "short"
        )
    tail += (held - promised) * RECORD
    return data[: HEADER + promised * RECORD], (f"{tail} bytes after the last triangle ignored",)


def _binary(data: bytes, remarks: tuple[str, ...]) -> Content:
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.frombuffer(data, record, offset=HEADER)["corners"]
    return Content((_body("solid 1", corners.reshape(-1, 3)),), None, None, True, remarks)


def _text(text: str) -> Content:
    remarks = []
    bodies = []
    for name, facets in SOLID.findall(text):
        words = VERTEX.findall(facets)
        if len(words) % 3:
            raise BadPart(
                f"text STL: solid {name.strip()!r} has {len(words)} vertices, not 3 a face"
            )
        commas = any("," in word for word in words[0]) if words else False
        if commas:
            words = [tuple(word.replace(",", ".") for word in row) for row in words]
            remarks.append("decimal commas read as points")
        if words:
            bodies.append(_body(name.strip() or f"solid {len(bodies) + 1}", _numbers(words)))
    if "endsolid" not in text[-4096:].lower():
        remarks.append("the text does not end with `endsolid`: it may be cut short")
    return Content(tuple(bodies), None, None, False, tuple(dict.fromkeys(remarks)))


def _numbers(words: list[tuple[str, ...]]) -> np.ndarray:
    try:
        return np.array(words).astype(np.float64)
    except ValueError as error:
        raise BadPart(f"text STL: a vertex is no number: {error}") from None


def _body(name: str, corners: np.ndarray) -> Body:
    count = len(corners) // 3
    faces = np.arange(3 * count, dtype=np.int64).reshape(-1, 3)
    return Body(name, corners.astype(np.float64), faces, unpainted(count))
