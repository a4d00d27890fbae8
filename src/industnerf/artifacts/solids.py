"""What one CAD file of the user's holds: its solids in mm, as read and not yet cleaned.

<file id>/solids.json    file, format, unit, names, finishes, remarks
<file id>/solids.npz     the meshes
"""

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from industnerf.artifacts.files import read_json, read_npz, write_json
from industnerf.artifacts.finish import Finish, finish_from
from industnerf.artifacts.part import Mesh
from industnerf.errors import BadArtifact

SCHEMA = 1


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
    unit: str  # of the file: "mm, stated", "inch, stated", "mm, assumed" (parts.units)
    finishes: tuple[Finish, ...]  # what the `finish` of every mesh counts; at least one
    remarks: tuple[str, ...]  # what the reader could not keep, or had to assume
    solids: tuple[Solid, ...]  # at least one, each with at least one face

    def save(self, folder: Path) -> None:
        """Write `solids.json` and `solids.npz` into `folder`."""
        facts = {
            "schema": SCHEMA,
            "file": self.file,
            "format": self.format,
            "unit": self.unit,
            "finishes": [asdict(finish) for finish in self.finishes],
            "remarks": self.remarks,
            "solids": [solid.name for solid in self.solids],
        }
        arrays = {
            f"{name}_{i}": array
            for i, solid in enumerate(self.solids)
            for name, array in vars(solid.mesh).items()
        }
        write_json(folder / "solids.json", facts)
        np.savez_compressed(folder / "solids.npz", **arrays)

    @staticmethod
    def load(folder: Path) -> "Solids":
        """Read what `save` wrote; raises BadArtifact if it is missing, torn or of another shape."""
        facts = read_json(folder / "solids.json", SCHEMA, "solids")
        path, arrays = folder / "solids.npz", list(Mesh.__annotations__)
        keys = [f"{name}_{i}" for i in range(len(facts["solids"])) for name in arrays]
        found = iter(read_npz(path, tuple(keys), "solids"))
        meshes = [
            _mesh(f"{path}: solid {name!r}", next(found), next(found), next(found), facts)
            for name in facts["solids"]
        ]
        return Solids(
            facts["file"],
            facts["format"],
            facts["unit"],
            tuple(finish_from(row) for row in facts["finishes"]),
            tuple(facts["remarks"]),
            tuple(Solid(n, m) for n, m in zip(facts["solids"], meshes, strict=True)),
        )


def names_of(folder: Path) -> tuple[str, ...]:
    """The names of the solids in `folder`, without their meshes; raises BadArtifact as `load`."""
    return tuple(read_json(folder / "solids.json", SCHEMA, "solids")["solids"])


def _mesh(
    what: str, vertices: np.ndarray, faces: np.ndarray, finish: np.ndarray, facts: dict
) -> Mesh:
    """Raises BadArtifact unless every face has three vertices and a finish that are there."""
    if vertices.shape[1:] != (3,) or faces.shape[1:] != (3,) or finish.shape != faces.shape[:1]:
        raise BadArtifact(f"{what} has shapes {vertices.shape}, {faces.shape} and {finish.shape}")
    if not len(faces) or faces.min() < 0 or faces.max() >= len(vertices):
        raise BadArtifact(f"{what} has no face, or one that names no vertex")
    if finish.max() >= len(facts["finishes"]):
        raise BadArtifact(f"{what} has a face without a finish")
    return Mesh(vertices, faces, finish)
