"""A part: one solid or assembly, its mesh in mm, its appearances and its metadata."""

import csv
import io
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int32, UInt8

from industnerf.artifacts.files import corrupt_error, read_json, read_npz, write_json, write_text
from industnerf.artifacts.ply import write_ply

SCHEMA = 2


@dataclass(frozen=True)
class Appearance:
    """A material as a camera sees it: its color and how it shines."""

    name: str
    albedo: tuple[float, float, float] | None  # linear, in [0, 1]; None: views.albedo decides
    metallic: float  # 0 matte or painted, 1 bare metal; matte shading ignores it
    roughness: float  # 0 mirror, 1 dull; matte shading ignores it


UNSPECIFIED = Appearance("unstated", None, 0.0, 1.0)


def appearance_from_json(row: dict) -> Appearance:
    """The appearance that JSON holds as `row`."""
    albedo = row["albedo"]
    return Appearance(**(row | {"albedo": None if albedo is None else tuple(albedo)}))


@dataclass(frozen=True)
class Part:
    """What `part.json` holds."""

    part_id: str
    family: str
    designation: str
    origin: str  # "embedded", "organic", or "file" for a part that the user brought
    source: str  # the library that drew it, or the file's name
    extents_mm: tuple[float, float, float]
    area_mm2: float
    volume_mm3: float | None  # None where the mesh is not closed
    bodies: int
    faces: int
    euler_number: int  # V - E + F; of a closed surface 2 (bodies - through holes)
    visible_share: float  # of the area, from a dense sphere of cameras
    hull_hidden_share: float  # of the area, what no silhouette shows (geometry/visual_hull.py)
    strata: tuple[str, ...]  # see industnerf.parts.strata
    finishes: tuple[Appearance, ...]  # that `Mesh.finish` indexes; at least one
    defects: tuple[str, ...]  # found and repaired, or found and left

    @property
    def diagonal_mm(self) -> float:
        """Diagonal of the bounding box."""
        return float(np.linalg.norm(self.extents_mm))


@dataclass(frozen=True)
class Mesh:
    """An indexed triangle mesh; shared vertices are welded."""

    vertices: Float[np.ndarray, "n 3"]  # mm, float64
    faces: Int32[np.ndarray, "m 3"]  # counter-clockwise seen from outside
    finish: UInt8[np.ndarray, "m"]  # of each face, an index into `Part.finishes`

    @staticmethod
    def with_one_appearance(
        vertices: Float[np.ndarray, "n 3"], faces: Int32[np.ndarray, "m 3"]
    ) -> "Mesh":
        """A mesh whose faces all have the appearance 0."""
        return Mesh(vertices, faces, np.zeros(len(faces), np.uint8))

    @property
    def triangles(self) -> Float[np.ndarray, "m 3 3"]:
        """Corner positions of every face, mm."""
        return self.vertices[self.faces]


def save_part(folder: Path, part: Part, mesh: Mesh) -> None:
    """Write `part.json`, `mesh.npz` and, for viewers, `mesh.ply` into `folder`."""
    write_json(folder / "part.json", {"schema": SCHEMA} | asdict(part))
    np.savez_compressed(folder / "mesh.npz", **vars(mesh))
    write_ply(folder / "mesh.ply", mesh.vertices, faces=mesh.faces)


def load_part(folder: Path) -> Part:
    """Read `part.json`; raises BadArtifact if it is missing, torn or of another schema."""
    content = read_json(folder / "part.json", SCHEMA, "parts")
    del content["schema"]
    for name in ("extents_mm", "strata", "defects"):
        content[name] = tuple(content[name])
    content["finishes"] = tuple(appearance_from_json(row) for row in content["finishes"])
    return Part(**content)


def load_mesh(folder: Path) -> Mesh:
    """Read `mesh.npz`; raises BadArtifact if it is missing or not a triangle mesh."""
    path = folder / "mesh.npz"
    vertices, faces, face_appearance = read_npz(path, ("vertices", "faces", "finish"), "parts")
    if (
        vertices.shape[1:] != (3,)
        or faces.shape[1:] != (3,)
        or face_appearance.shape != faces.shape[:1]
    ):
        what = f"has shapes {vertices.shape}, {faces.shape} and {face_appearance.shape}"
        raise corrupt_error(path, what, "parts")
    return Mesh(
        vertices.astype(np.float64), faces.astype(np.int32), face_appearance.astype(np.uint8)
    )


def load_parts(folder: Path) -> list[Part]:
    """Every part below `folder`, by id."""
    return [load_part(path.parent) for path in sorted(folder.glob("*/part.json"))]


def write_manifest(folder: Path) -> None:
    """Write `manifest.csv`, one row a part, for people and spreadsheets."""
    lists = ("extents_mm", "strata", "finishes", "defects")
    columns = [name for name in Part.__dataclass_fields__ if name not in lists]
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow([*columns, "x_mm", "y_mm", "z_mm", "strata", "finishes", "defects"])
    for part in load_parts(folder):
        values = [getattr(part, name) for name in columns]
        appearances = (appearance.name for appearance in part.finishes)
        joined_lists = ("; ".join(several) for several in (part.strata, appearances, part.defects))
        table.writerow([*values, *part.extents_mm, *joined_lists])
    write_text(folder / "manifest.csv", text.getvalue())
