"""Materials beside an OBJ file: the diffuse colour or picture of each."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.parts.reading.formats import text_of
from industnerf.parts.reading.paint import linear
from industnerf.parts.reading.sidecars import named


@dataclass(frozen=True)
class Material:
    """What a face of it looks like; the picture goes before the colour."""

    albedo: Float64[np.ndarray, "3"] | None
    picture: Path | None


def materials(path: Path) -> dict[str, Material]:
    """The materials in the MTL file at `path`, by name; lines that make no sense are skipped."""
    found: dict[str, Material] = {}
    name = None
    for line in text_of(path.read_bytes()).splitlines():
        key, _, rest = line.strip().partition(" ")
        if key.lower() == "newmtl":
            name = rest.strip()
            found[name] = Material(None, None)
        elif key.lower() == "kd" and name is not None:
            found[name] = Material(_colour(rest), found[name].picture)
        elif key.lower() == "map_kd" and name is not None:
            found[name] = Material(found[name].albedo, named(path, rest))
    return found


def _colour(text: str) -> Float64[np.ndarray, "3"] | None:
    try:
        return linear(np.array([float(word) for word in text.split()[:3]]).reshape(3))
    except ValueError:
        return None
