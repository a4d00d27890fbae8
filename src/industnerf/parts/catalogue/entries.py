"""The stored parts: read, checked against their hash, and installed into a part folder.

Each part is `data/embedded/<id>.npz`: `vertices` (n, 3) float32 in mm, in the frame of the
drawing, `faces` (m, 3), counter-clockwise from outside, and `finish` (m,), an index into the
part's finishes.  The arrays are indexed.  Do not weld them by position: neighboring thread
crests come closer than any safe tolerance.
"""

import hashlib
import json
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float32, Integer, UInt8

from industnerf.artifacts.part import Appearance, Mesh, Part, appearance_from_json, save_part
from industnerf.errors import BadArtifact, BadPart
from industnerf.parts.measure import MeshProperties

SCHEMA = 2
EMBEDDED_FOLDER = Path(__file__).parents[4] / "data" / "embedded"
REBUILD_HINT = (
    "restore it from version control, or run `python -m industnerf.parts build [--set organic]`"
)


@dataclass(frozen=True)
class CatalogueEntry:
    """What is known of a stored part without opening its mesh."""

    id: str
    designation: str  # standard and size; "-like" where the proportions are ours
    family: str
    origin: str  # the set: "embedded", or "organic" for the non-industrial one
    library: str  # that drew it
    parameters: dict[str, float | int | str]  # of the drawing; lengths in mm
    finishes: tuple[Appearance, ...]  # that the mesh counts
    measured: MeshProperties
    back_face_share: float  # of the rays from outside that hit; 0 for a sound surface
    reference: Literal["b-rep", "finer mesh"]  # what the volume is compared with
    reference_volume_mm3: float  # exact if the part is one B-rep solid; else of a 4x finer mesh
    sha256: str  # of the mesh: see `mesh_digest`

    @property
    def volume_deviation(self) -> float:
        """Of the mesh from the reference, as a share."""
        return self.measured.volume_mm3 / self.reference_volume_mm3 - 1


def read_catalogue(folder: Path = EMBEDDED_FOLDER) -> tuple[CatalogueEntry, ...]:
    """All stored parts, by family and then by id.

    Raises `BadArtifact` if the catalogue is missing, torn or of another schema.
    """
    path = folder / "catalogue.json"
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        if stored["schema"] != SCHEMA:
            raise BadArtifact(
                f"{path}: catalogue schema {stored['schema']}, this code reads {SCHEMA}; "
                f"{REBUILD_HINT}"
            )
        return tuple(_parse_entry(row) for row in stored["parts"])
    except FileNotFoundError:
        raise BadArtifact(f"{path} is missing; {REBUILD_HINT}") from None
    except (ValueError, KeyError, TypeError) as error:
        raise BadArtifact(f"{path} cannot be read ({error}); {REBUILD_HINT}") from error


def _parse_entry(row: dict) -> CatalogueEntry:
    measured = dict(row["measured"])
    for name in ("extents_mm", "strata"):
        measured[name] = tuple(measured[name])
    finishes = tuple(appearance_from_json(finish) for finish in row["finishes"])
    return CatalogueEntry(**(row | {"measured": MeshProperties(**measured), "finishes": finishes}))


def load_catalogue_mesh(entry: CatalogueEntry, folder: Path = EMBEDDED_FOLDER) -> Mesh:
    """The mesh of a stored part, in mm.

    Raises `BadArtifact` if the file is missing or torn, `BadPart` if it is not the mesh that the
    catalogue describes.
    """
    path = folder / f"{entry.id}.npz"
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            vertices, faces, finish = (arrays[n] for n in ("vertices", "faces", "finish"))
    except FileNotFoundError:
        raise BadArtifact(f"{path} is missing; {REBUILD_HINT}") from None
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise BadArtifact(f"{path} cannot be read ({error}); {REBUILD_HINT}") from error
    actual = mesh_digest(vertices, faces, finish)
    if actual != entry.sha256:
        raise BadPart(
            f"part {entry.id!r}: {path} holds another mesh than the catalogue describes "
            f"(sha256 {actual[:12]}..., expected {entry.sha256[:12]}...). It was edited, or only "
            f"one of the two was updated; {REBUILD_HINT}"
        )
    return Mesh(vertices.astype(np.float64), faces.astype(np.int32), finish)


def mesh_digest(
    vertices: Float32[np.ndarray, "n 3"],
    faces: Integer[np.ndarray, "m 3"],
    finish: UInt8[np.ndarray, "m"],
) -> str:
    """SHA-256 of the vertices as little-endian float32, the faces as int32, then the finishes.

    It names the mesh: the file's compression and its index type do not enter.
    """
    sha = hashlib.sha256(np.ascontiguousarray(vertices, dtype="<f4").tobytes())
    sha.update(np.ascontiguousarray(faces, dtype="<i4").tobytes())
    sha.update(finish.tobytes())
    return sha.hexdigest()


def install_catalogue_part(folder: Path, entry: CatalogueEntry, target: Path) -> None:
    """Write the part folder of a stored part; raises BadPart or BadArtifact if it is not sound."""
    save_part(target, to_part(entry), load_catalogue_mesh(entry, folder))


def to_part(entry: CatalogueEntry) -> Part:
    """What `part.json` says of a stored part."""
    return Part(
        part_id=entry.id,
        family=entry.family,
        designation=entry.designation,
        origin=entry.origin,
        source=entry.library,
        finishes=entry.finishes,
        defects=(),
        **vars(entry.measured),
    )
