"""The lines of an OBJ file, taken one by one."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from industnerf.errors import BadPart
from industnerf.parts.io.readers.formats import decode_text
from industnerf.parts.io.readers.polygons import triangulate_polygon


@dataclass
class ObjObject:
    """Triangles of one `o`, as they come."""

    name: str
    corners: list[tuple[int, int, int]] = field(default_factory=list)
    uvs: list[tuple[int, int, int]] = field(default_factory=list)
    materials: list[str] = field(default_factory=list)


@dataclass
class ObjScene:
    """What has been read so far."""

    points: list[list[float]] = field(default_factory=list)
    colors: dict[int, list[float]] = field(default_factory=dict)
    uvs: list[list[float]] = field(default_factory=list)
    objects: list[ObjObject] = field(default_factory=lambda: [ObjObject("")])
    libraries: list[str] = field(default_factory=list)
    current_material: str = ""
    num_degenerate: int = 0  # faces of fewer than three corners

    @property
    def warnings(self) -> list[str]:
        """What was left out."""
        return (
            [f"faces of fewer than 3 corners dropped: {self.num_degenerate}"]
            if self.num_degenerate
            else []
        )


def parse_obj(path: Path) -> ObjScene:
    """All that the file says; raises BadPart that names the line if one makes no sense."""
    scene = ObjScene()
    for number, line in logical_lines(decode_text(path.read_bytes())):
        try:
            parse_line(scene, line.split())
        except (ValueError, IndexError) as error:
            raise BadPart(f"OBJ: line {number}, {line.strip()[:60]!r}: {error}") from None
    return scene


def logical_lines(text: str) -> Iterator[tuple[int, str]]:
    """Each line, and its number; after a backslash it goes on in the next, as one line."""
    first, pending = 1, ""
    for number, line in enumerate(text.splitlines(), start=1):
        first = first if pending else number
        if line.endswith("\\"):
            pending += line[:-1] + " "
        else:
            yield first, pending + line
            pending = ""
    yield first, pending


def parse_line(scene: ObjScene, tokens: list[str]) -> None:
    """Add what one line says; raises ValueError or IndexError if it makes no sense."""
    key, rest = (tokens[0], tokens[1:]) if tokens else ("", [])
    if key == "v":
        if len(rest) < 3:
            raise ValueError("a vertex has three coordinates")
        numbers = [float(token) for token in rest]
        if len(rest) >= 6:
            scene.colors[len(scene.points)] = numbers[3:6]
        scene.points.append(numbers[:3])
    elif key == "vt":
        scene.uvs.append([*map(float, rest[:2]), 0.0, 0.0][:2])
    elif key == "f":
        _parse_face(scene, rest)
    elif key == "o":
        scene.objects.append(ObjObject(" ".join(rest)))
    elif key == "usemtl":
        scene.current_material = " ".join(rest)
    elif key == "mtllib":
        scene.libraries.append(" ".join(rest))


def _parse_face(scene: ObjScene, tokens: list[str]) -> None:
    parts = [token.split("/") for token in tokens]
    corners = [_parse_index(part[0], len(scene.points), "vertex") for part in parts]
    if len(corners) < 3:
        scene.num_degenerate += 1
        return
    textured = all(len(part) > 1 and part[1] for part in parts)
    uvs = [_parse_index(p[1], len(scene.uvs), "texture point") if textured else -1 for p in parts]
    triples = [(0, 1, 2)]
    if len(corners) > 3:
        triples = triangulate_polygon(np.array([scene.points[i] for i in corners])).tolist()
    target = scene.objects[-1]
    target.corners += [(corners[a], corners[b], corners[c]) for a, b, c in triples]
    target.uvs += [(uvs[a], uvs[b], uvs[c]) for a, b, c in triples]
    target.materials += [scene.current_material] * len(triples)


def _parse_index(token: str, count: int, label: str) -> int:
    """From 1, or from the end where it is negative, to from 0."""
    number = int(token)
    index = number - 1 if number > 0 else count + number
    if not 0 <= index < count or number == 0:
        raise ValueError(f"{label} {number}, and so far there are {count}")
    return index
