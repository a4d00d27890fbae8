"""Materials beside an OBJ file: the diffuse color or picture of each."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.parts.io.readers.colors import srgb_to_linear
from industnerf.parts.io.readers.formats import decode_text
from industnerf.parts.io.readers.sidecars import resolve_sidecar


@dataclass(frozen=True)
class Material:
    """What a face of it looks like; the picture goes before the color."""

    albedo: Float64[np.ndarray, "3"] | None
    image_path: Path | None


def read_mtl(path: Path) -> dict[str, Material]:
    """The materials in the MTL file at `path`, by name; lines that make no sense are skipped."""
    materials: dict[str, Material] = {}
    name = None
    for line in decode_text(path.read_bytes()).splitlines():
        key, _, rest = line.strip().partition(" ")
        if key.lower() == "newmtl":
            name = rest.strip()
            materials[name] = Material(None, None)
        elif key.lower() == "kd" and name is not None:
            materials[name] = Material(_parse_color(rest), materials[name].image_path)
        elif key.lower() == "map_kd" and name is not None:
            materials[name] = Material(materials[name].albedo, resolve_sidecar(path, rest))
    return materials


def _parse_color(text: str) -> Float64[np.ndarray, "3"] | None:
    try:
        return srgb_to_linear(np.array([float(token) for token in text.split()[:3]]).reshape(3))
    except ValueError:
        return None
