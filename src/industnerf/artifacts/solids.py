"""The solids of one CAD file of the user's in mm, as read and not yet repaired.

<file id>/solids.json    file, format, unit, names, finishes, warnings
<file id>/solids.npz     the meshes
"""

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from industnerf.artifacts.files import read_json, read_npz, write_json
from industnerf.artifacts.part import Appearance, Mesh, appearance_from_json
from industnerf.errors import BadArtifact

SCHEMA = 2


@dataclass(frozen=True)
class Solid:
    """One body of a file; it need not be closed."""

    name: str  # as the file has it, else "solid 1" and so on
    mesh: Mesh


@dataclass(frozen=True)
class Solids:
    """One file, read."""

    file: str  # its name
    format: str  # for people, by content: "binary STL", "STEP"
    unit: str  # "inch, stated" by the file; "mm, assumed" or "mm, overridden" by parts.units
    finishes: tuple[Appearance, ...]  # that the `finish` of every mesh indexes; at least one
    warnings: tuple[str, ...]  # what the reader could not keep, or had to assume
    solids: tuple[Solid, ...]  # at least one, each with at least one face

    def save(self, folder: Path) -> None:
        """Write `solids.json` and `solids.npz` into `folder`."""
        metadata = {
            "schema": SCHEMA,
            "file": self.file,
            "format": self.format,
            "unit": self.unit,
            "finishes": [asdict(appearance) for appearance in self.finishes],
            "warnings": self.warnings,
            "solids": [solid.name for solid in self.solids],
        }
        arrays = {
            f"{name}_{i}": array
            for i, solid in enumerate(self.solids)
            for name, array in vars(solid.mesh).items()
        }
        write_json(folder / "solids.json", metadata)
        np.savez_compressed(folder / "solids.npz", **arrays)

    @staticmethod
    def load(folder: Path) -> "Solids":
        """Read what `save` wrote; raises BadArtifact if it is missing, torn or of another shape."""
        metadata = read_json(folder / "solids.json", SCHEMA, "solids")
        path, arrays = folder / "solids.npz", list(Mesh.__annotations__)
        keys = [f"{name}_{i}" for i in range(len(metadata["solids"])) for name in arrays]
        stored_arrays = iter(read_npz(path, tuple(keys), "solids"))
        meshes = [
            _checked_mesh(
                f"{path}: solid {name!r}",
                next(stored_arrays),
                next(stored_arrays),
                next(stored_arrays),
                metadata,
            )
            for name in metadata["solids"]
        ]
        return Solids(
            metadata["file"],
            metadata["format"],
            metadata["unit"],
            tuple(appearance_from_json(row) for row in metadata["finishes"]),
            tuple(metadata["warnings"]),
            tuple(Solid(n, m) for n, m in zip(metadata["solids"], meshes, strict=True)),
        )


def solid_names(folder: Path) -> tuple[str, ...]:
    """The names of the solids in `folder`, without their meshes; raises BadArtifact as `load`."""
    return tuple(read_json(folder / "solids.json", SCHEMA, "solids")["solids"])


def _checked_mesh(
    what: str, vertices: np.ndarray, faces: np.ndarray, face_appearance: np.ndarray, metadata: dict
) -> Mesh:
    """Raises BadArtifact unless every face has three vertices and an appearance that exist."""
    if (
        vertices.shape[1:] != (3,)
        or faces.shape[1:] != (3,)
        or face_appearance.shape != faces.shape[:1]
    ):
        raise BadArtifact(
            f"{what} has shapes {vertices.shape}, {faces.shape} and {face_appearance.shape}"
        )
    if not len(faces) or faces.min() < 0 or faces.max() >= len(vertices):
        raise BadArtifact(f"{what} has no face, or one that names no vertex")
    if face_appearance.max() >= len(metadata["finishes"]):
        raise BadArtifact(f"{what} has a face without an appearance")
    return Mesh(vertices, faces, face_appearance)
