"""The embedded parts as they were baked: read, checked against their hash, and nothing else.

Each part is `data/embedded/<id>.npz`: `vertices` (n, 3) float32 in mm, in the frame of the
drawing, and `faces` (m, 3), counter-clockwise from outside.  The arrays are indexed: never weld
them again by position, for neighbouring thread crests come closer than any safe tolerance.
"""

import hashlib
import json
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float32, Float64, Int32, Integer

from industnerf.errors import BadArtifact, BadPart

SCHEMA = 1
EMBEDDED = Path(__file__).parents[3] / "data" / "embedded"
REBUILD = "restore data/embedded from version control, or run `python -m industnerf.parts build`"


@dataclass(frozen=True)
class Entry:
    """What is known of a baked part without opening its mesh."""

    id: str
    designation: str  # standard and size; "-like" where the proportions are ours
    family: str
    library: str  # that drew it
    parameters: dict[str, float | int | str]  # of the drawing; lengths in mm
    volume_mm3: float
    area_mm2: float
    extents_mm: tuple[float, float, float]
    faces: int
    bodies: int  # connected pieces of surface
    back_face_share: float  # of the rays from outside that hit; 0 for a sound surface
    brep_volume_mm3: float | None  # exact; None unless the part is one B-rep solid
    volume_deviation: float | None  # (volume_mm3 - brep_volume_mm3) / brep_volume_mm3
    sha256: str  # of the mesh: see `digest`


def catalogue(folder: Path = EMBEDDED) -> tuple[Entry, ...]:
    """All baked parts, by family and then by id.

    Raises `BadArtifact` if the catalogue is missing, torn or of another schema.
    """
    path = folder / "catalogue.json"
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        if stored["schema"] != SCHEMA:
            raise BadArtifact(
                f"{path}: catalogue schema {stored['schema']}, this code reads {SCHEMA}; {REBUILD}"
            )
        rows = [{**row, "extents_mm": tuple(row["extents_mm"])} for row in stored["parts"]]
        return tuple(Entry(**row) for row in rows)
    except FileNotFoundError:
        raise BadArtifact(f"{path} is missing; {REBUILD}") from None
    except (ValueError, KeyError, TypeError) as error:
        raise BadArtifact(f"{path} cannot be read ({error}); {REBUILD}") from error


def load(
    entry: Entry, folder: Path = EMBEDDED
) -> tuple[Float64[np.ndarray, "n 3"], Int32[np.ndarray, "m 3"]]:
    """Vertices (mm) and faces of a baked part.

    Raises `BadArtifact` if the file is missing or torn, `BadPart` if it is not the mesh that the
    catalogue describes.
    """
    path = folder / f"{entry.id}.npz"
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            vertices, faces = arrays["vertices"], arrays["faces"]
    except FileNotFoundError:
        raise BadArtifact(f"{path} is missing; {REBUILD}") from None
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise BadArtifact(f"{path} cannot be read ({error}); {REBUILD}") from error
    found = digest(vertices, faces)
    if found != entry.sha256:
        raise BadPart(
            f"part {entry.id!r}: {path} holds another mesh than the catalogue describes "
            f"(sha256 {found[:12]}..., expected {entry.sha256[:12]}...). It was edited, or only "
            f"one of the two was updated; {REBUILD}"
        )
    return vertices.astype(np.float64), faces.astype(np.int32)


def digest(vertices: Float32[np.ndarray, "n 3"], faces: Integer[np.ndarray, "m 3"]) -> str:
    """SHA-256 of the vertices as little-endian float32, then the faces as little-endian int32.

    It names the mesh: the file's compression and its index type do not enter.
    """
    sha = hashlib.sha256(np.ascontiguousarray(vertices, dtype="<f4").tobytes())
    sha.update(np.ascontiguousarray(faces, dtype="<i4").tobytes())
    return sha.hexdigest()
