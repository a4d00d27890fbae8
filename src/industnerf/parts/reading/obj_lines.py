"""The lines of an OBJ file, taken one by one."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from industnerf.errors import BadPart
from industnerf.parts.reading.formats import text_of
from industnerf.parts.reading.polygons import triangles


@dataclass
class Object:
    """Triangles of one `o`, as they come."""

    name: str
    corners: list[tuple[int, int, int]] = field(default_factory=list)
    uvs: list[tuple[int, int, int]] = field(default_factory=list)
    materials: list[str] = field(default_factory=list)


@dataclass
class Scene:
    """What has been read so far."""

    points: list[list[float]] = field(default_factory=list)
    colours: dict[int, list[float]] = field(default_factory=dict)
    uvs: list[list[float]] = field(default_factory=list)
    objects: list[Object] = field(default_factory=lambda: [Object("")])
    libraries: list[str] = field(default_factory=list)
    material: str = ""
    stubs: int = 0  # faces of fewer than three corners

    @property
    def remarks(self) -> list[str]:
        """What was left out."""
        return [f"faces of fewer than 3 corners dropped: {self.stubs}"] if self.stubs else []


def scene_of(path: Path) -> Scene:
    """All that the file says; raises BadPart that names the line if one makes no sense."""
    scene = Scene()
    for number, line in joined(text_of(path.read_bytes())):
        try:
            take(scene, line.split())
        except (ValueError, IndexError) as error:
            raise BadPart(f"OBJ: line {number}, {line.strip()[:60]!r}: {error}") from None
    return scene


def joined(text: str) -> Iterator[tuple[int, str]]:
    """Each line, and its number; after a backslash it goes on in the next, as one line."""
    first, begun = 1, ""
    for number, line in enumerate(text.splitlines(), start=1):
        first = first if begun else number
        if line.endswith("\\"):
            begun += line[:-1] + " "
        else:
            yield first, begun + line
            begun = ""
    yield first, begun


def take(scene: Scene, words: list[str]) -> None:
    """Add what one line says; raises ValueError or IndexError if it makes no sense."""
    key, rest = (words[0], words[1:]) if words else ("", [])
    if key == "v":
        if len(rest) < 3:
            raise ValueError("a vertex has three coordinates")
        numbers = [float(word) for word in rest]
        if len(rest) >= 6:
            scene.colours[len(scene.points)] = numbers[3:6]
        scene.points.append(numbers[:3])
    elif key == "vt":
        scene.uvs.append([*map(float, rest[:2]), 0.0, 0.0][:2])
    elif key == "f":
        _face(scene, rest)
    elif key == "o":
        scene.objects.append(Object(" ".join(rest)))
    elif key == "usemtl":
        scene.material = " ".join(rest)
    elif key == "mtllib":
        scene.libraries.append(" ".join(rest))


def _face(scene: Scene, words: list[str]) -> None:
    parts = [word.split("/") for word in words]
    corners = [_index(part[0], len(scene.points), "vertex") for part in parts]
    if len(corners) < 3:
        scene.stubs += 1
        return
    textured = all(len(part) > 1 and part[1] for part in parts)
    uvs = [_index(p[1], len(scene.uvs), "texture point") if textured else -1 for p in parts]
    cut = [(0, 1, 2)]
    if len(corners) > 3:
        cut = triangles(np.array([scene.points[i] for i in corners])).tolist()
    into = scene.objects[-1]
    into.corners += [(corners[a], corners[b], corners[c]) for a, b, c in cut]
    into.uvs += [(uvs[a], uvs[b], uvs[c]) for a, b, c in cut]
    into.materials += [scene.material] * len(cut)


def _index(word: str, count: int, what: str) -> int:
    """From 1, or from the end where it is negative, to from 0."""
    number = int(word)
    index = number - 1 if number > 0 else count + number
    if not 0 <= index < count or number == 0:
        raise ValueError(f"{what} {number}, and so far there are {count}")
    return index
