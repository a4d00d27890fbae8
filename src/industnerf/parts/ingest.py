"""The solids of one file of the user's to a part folder."""

from pathlib import Path

import numpy as np

from industnerf.artifacts.finish import Finish
from industnerf.artifacts.part import Mesh, Part, save_part
from industnerf.artifacts.solids import Solids
from industnerf.parts.cleaning import clean
from industnerf.parts.measure import measure
from industnerf.parts.units import unit_note
from industnerf.schema import CleanParams


def ingest(
    folder: Path,
    part_id: str,
    family: str,
    which: int | None,
    settings: CleanParams,
    target: Path,
) -> None:
    """Write the part folder of what `folder` holds, or of its solid number `which` alone.

    Raises BadArtifact if `folder` holds no `Solids`, BadPart if no surface is left after cleaning.
    """
    file = Solids.load(folder)
    chosen = file.solids if which is None else (file.solids[which],)
    cleaned = clean([solid.mesh for solid in chosen], settings)
    mesh, finishes = used_finishes(cleaned.mesh, file.finishes)
    facts = measure(mesh)
    note = unit_note(file.unit, max(facts.extents_mm))
    part = Part(
        part_id=part_id,
        family=family,
        designation=file.file if which is None else f"{file.file}: {chosen[0].name}",
        origin="file",
        source=f"{file.file} ({file.format}; {file.unit})",
        finishes=finishes,
        defects=(*file.remarks, *filter(None, [note]), *cleaned.mended, *cleaned.remaining),
        **vars(facts),
    )
    save_part(target, part, mesh)


def used_finishes(mesh: Mesh, finishes: tuple[Finish, ...]) -> tuple[Mesh, tuple[Finish, ...]]:
    """`mesh` and `finishes` without the finishes that no face has."""
    used, finish = np.unique(mesh.finish, return_inverse=True)
    renumbered = Mesh(mesh.vertices, mesh.faces, finish.astype(np.uint8))
    return renumbered, tuple(finishes[i] for i in used)
