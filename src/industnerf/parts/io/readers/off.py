"""OFF, and COFF with colors of vertices.  It states no unit.

Not through trimesh, which reads no colors (benchmarks/readers.md).
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.io.readers.colors import srgb_to_linear
from industnerf.parts.io.readers.formats import decode_text
from industnerf.parts.io.readers.mesh_content import (
    MeshBody,
    MeshContent,
    require_valid_indices,
    unstated_albedo,
)
from industnerf.parts.io.readers.polygons import triangulate_polygon


def read_off(path: Path) -> MeshContent:
    """Raises BadPart if the counts and the rows disagree."""
    rows = [line.partition("#")[0].split() for line in decode_text(path.read_bytes()).splitlines()]
    rows = [row for row in rows if row]
    start = rows[0] if rows else [""]
    header = start[0].upper()
    if not header.endswith("OFF") or "4" in header or "BINARY" in start:
        raise BadPart(f"OFF: begins with {' '.join(start)[:40]!r}: only text OFF and COFF are read")
    try:
        counts, rows = (start[1:], rows[1:]) if len(start) > 1 else (rows[1], rows[2:])
        vertices, faces = int(counts[0]), int(counts[1])
        if min(vertices, faces) < 0 or vertices + faces > len(rows):
            raise BadPart(
                f"OFF: promises {vertices} vertices and {faces} faces, and has {len(rows)} rows"
            )
        return _read_content(header, rows[:vertices], rows[vertices : vertices + faces])
    except (ValueError, IndexError) as error:
        raise BadPart(f"OFF: {error}") from None


def _read_content(header: str, points: list[list[str]], polygons: list[list[str]]) -> MeshContent:
    vertices = np.array([row[:3] for row in points]).reshape(-1, 3).astype(np.float64)
    corners, color_tokens = [], []
    for row in polygons:
        count = int(row[0])
        indices = np.array(row[1 : 1 + count], np.int64)
        if len(indices) != count or count < 3:
            raise BadPart(f"OFF: a face promises {count} corners and has {len(indices)}")
        require_valid_indices(indices[None], len(vertices), "OFF")
        triples = indices[triangulate_polygon(vertices[indices])] if count > 3 else indices[None]
        corners.append(triples)
        color_tokens += [row[1 + count :]] * len(triples)
    faces = np.concatenate(corners) if corners else np.zeros((0, 3), np.int64)
    albedo = np.array([_parse_color(tokens) for tokens in color_tokens]).reshape(-1, 3)
    if header.startswith("C") and np.isnan(albedo).all():
        first = 6 if "N" in header[:-3] else 3  # behind the normals, if it has them
        albedo = np.array([_parse_color(row[first:]) for row in points])[faces].mean(axis=1)
    body, num_points = (
        MeshBody("solid 1", vertices, faces, albedo),
        0 if len(faces) else len(vertices),
    )
    return MeshContent((body,), None, None, False, num_points=num_points)


def _parse_color(tokens: list[str]) -> Float64[np.ndarray, "3"]:
    """Three numbers up to 255, or up to 1 where they have a point; anything else is no color."""
    if len(tokens) < 3:
        return unstated_albedo(1)[0]
    is_integer = all(token.isdigit() for token in tokens[:3])
    return srgb_to_linear(
        np.array([float(token) for token in tokens[:3]]) / (255 if is_integer else 1)
    )
