"""OFF, and COFF with colours of vertices.  It states no unit."""

from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.reading.content import Body, Content, require_indices, unpainted
from industnerf.parts.reading.formats import text_of
from industnerf.parts.reading.paint import linear
from industnerf.parts.reading.polygons import triangles


def read_off(path: Path) -> Content:
    """Raises BadPart if the counts and the rows disagree."""
    rows = [line.partition("#")[0].split() for line in text_of(path.read_bytes()).splitlines()]
    rows = [row for row in rows if row]
    start = rows[0] if rows else [""]
    head = start[0].upper()
    if not head.endswith("OFF") or "4" in head or "BINARY" in start:
        raise BadPart(f"OFF: begins with {' '.join(start)[:40]!r}: only text OFF and COFF are read")
    try:
        counts, rows = (start[1:], rows[1:]) if len(start) > 1 else (rows[1], rows[2:])
        vertices, faces = int(counts[0]), int(counts[1])
        if min(vertices, faces) < 0 or vertices + faces > len(rows):
            raise BadPart(
                f"OFF: promises {vertices} vertices and {faces} faces, and has {len(rows)} rows"
            )
        return _content(head, rows[:vertices], rows[vertices : vertices + faces])
    except (ValueError, IndexError) as error:
        raise BadPart(f"OFF: {error}") from None


def _content(head: str, points: list[list[str]], polygons: list[list[str]]) -> Content:
    vertices = np.array([row[:3] for row in points]).reshape(-1, 3).astype(np.float64)
    corners, paint = [], []
    for row in polygons:
        count = int(row[0])
        indices = np.array(row[1 : 1 + count], np.int64)
        if len(indices) != count or count < 3:
            raise BadPart(f"OFF: a face promises {count} corners and has {len(indices)}")
        require_indices(indices[None], len(vertices), "OFF")
        cut = indices[triangles(vertices[indices])] if count > 3 else indices[None]
        corners.append(cut)
        paint += [row[1 + count :]] * len(cut)
    faces = np.concatenate(corners) if corners else np.zeros((0, 3), np.int64)
    albedo = np.array([_colour(words) for words in paint]).reshape(-1, 3)
    if head.startswith("C") and np.isnan(albedo).all():
        first = 6 if "N" in head[:-3] else 3  # behind the normals, if it has them
        albedo = np.array([_colour(row[first:]) for row in points])[faces].mean(axis=1)
    return Content((Body("solid 1", vertices, faces, albedo),), None, None, False)


def _colour(words: list[str]) -> Float64[np.ndarray, "3"]:
    """Three numbers up to 255, or up to 1 where they have a point; anything else is no colour."""
    if len(words) < 3:
        return unpainted(1)[0]
    whole = all(word.isdigit() for word in words[:3])
    return linear(np.array([float(word) for word in words[:3]]) / (255 if whole else 1))
