"""A part: one solid, its mesh in mm and what is known about it."""

import csv
import io
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int32

from industnerf.artifacts.files import read_json, read_npz, write_json, write_text
from industnerf.artifacts.ply import write_ply
from industnerf.errors import BadArtifact

SCHEMA = 1


@dataclass(frozen=True)
class Part:
    """What `part.json` holds."""

    part_id: str
    family: str
    designation: str
    origin: str  # "embedded", or "file" for a part that the user brought
    source: str  # the library that drew it, or the file's name
    extents_mm: tuple[float, float, float]
    area_mm2: float
    volume_mm3: float | None  # None where the mesh is not closed
    bodies: int
    faces: int
    visible_share: float  # of the area, from a dense sphere of eyes
    defects: tuple[str, ...]  # found and mended, or found and left

    @property
    def diagonal_mm(self) -> float:
        """Diagonal of the bounding box."""
        return float(np.linalg.norm(self.extents_mm))


@dataclass(frozen=True)
class Mesh:
    """An indexed triangle mesh; shared vertices are welded."""

    vertices: Float[np.ndarray, "n 3"]  # mm, float64
    faces: Int32[np.ndarray, "m 3"]

    @property
    def triangles(self) -> Float[np.ndarray, "m 3 3"]:
        """Corner positions of every face, mm."""
        return self.vertices[self.faces]


def save_part(folder: Path, part: Part, mesh: Mesh) -> None:
    """Write `part.json`, `mesh.npz` and, for viewers, `mesh.ply` into `folder`."""
    write_json(folder / "part.json", {"schema": SCHEMA} | asdict(part))
    np.savez_compressed(folder / "mesh.npz", vertices=mesh.vertices, faces=mesh.faces)
    write_ply(folder / "mesh.ply", mesh.vertices, faces=mesh.faces)


def load_part(folder: Path) -> Part:
    """Read `part.json`; raises BadArtifact if it is missing, torn or of another schema."""
    content = read_json(folder / "part.json", SCHEMA, "parts")
    del content["schema"]
    content["extents_mm"] = tuple(content["extents_mm"])
    content["defects"] = tuple(content["defects"])
    return Part(**content)


def load_mesh(folder: Path) -> Mesh:
    """Read `mesh.npz`; raises BadArtifact if it is missing or not a triangle mesh."""
    path = folder / "mesh.npz"
    vertices, faces = read_npz(path, ("vertices", "faces"), "parts")
    mesh = Mesh(vertices.astype(np.float64), faces.astype(np.int32))
    if mesh.vertices.shape[1:] != (3,) or mesh.faces.shape[1:] != (3,):
        raise BadArtifact(f"{path}: shapes {mesh.vertices.shape} and {mesh.faces.shape}")
    return mesh


def load_parts(folder: Path) -> list[Part]:
    """Every part below `folder`, by id."""
    return [load_part(path.parent) for path in sorted(folder.glob("*/part.json"))]


def write_manifest(folder: Path) -> None:
    """Write `manifest.csv`, one row a part, for people and spreadsheets."""
    columns = [name for name in Part.__dataclass_fields__ if name not in ("extents_mm", "defects")]
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow([*columns, "x_mm", "y_mm", "z_mm", "defects"])
    for part in load_parts(folder):
        values = [getattr(part, name) for name in columns]
        table.writerow([*values, *part.extents_mm, "; ".join(part.defects)])
    write_text(folder / "manifest.csv", text.getvalue())
