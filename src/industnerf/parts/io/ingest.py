"""The solids of one file of the user's to a part folder."""

from pathlib import Path

import numpy as np

from industnerf.artifacts.part import Appearance, Mesh, Part, save_part
from industnerf.artifacts.part_warnings import save_part_warnings
from industnerf.artifacts.solids import Solids
from industnerf.parts.io.units import unit_note
from industnerf.parts.measure import measure
from industnerf.parts.repair import repair_mesh
from industnerf.schema import RepairParams


def ingest(
    folder: Path,
    part_id: str,
    family: str,
    solid_index: int | None,
    settings: RepairParams,
    target: Path,
) -> None:
    """Write the part folder of what `folder` holds, or of its solid `solid_index` alone.

    Raises BadArtifact if `folder` holds no `Solids`, BadPart if the repair leaves no surface.
    """
    file = Solids.load(folder)
    selected = file.solids if solid_index is None else (file.solids[solid_index],)
    repaired = repair_mesh([solid.mesh for solid in selected], settings)
    mesh, finishes = used_appearances(repaired.mesh, file.finishes)
    properties = measure(mesh)
    note = unit_note(file.unit, max(properties.extents_mm))
    part = Part(
        part_id=part_id,
        family=family,
        designation=file.file if solid_index is None else f"{file.file}: {selected[0].name}",
        origin="file",
        source=f"{file.file} ({file.format}; {file.unit})",
        finishes=finishes,
        defects=(
            *file.warnings,
            *filter(None, [note]),
            *repaired.repairs,
            *repaired.residual_defects,
        ),
        **vars(properties),
    )
    save_part(target, part, mesh)
    save_part_warnings(target, [*file.warnings, note, *repaired.residual_defects])


def used_appearances(
    mesh: Mesh, finishes: tuple[Appearance, ...]
) -> tuple[Mesh, tuple[Appearance, ...]]:
    """`mesh` and `finishes` without the finishes that no face has."""
    used, finish = np.unique(mesh.finish, return_inverse=True)
    renumbered = Mesh(mesh.vertices, mesh.faces, finish.astype(np.uint8))
    return renumbered, tuple(finishes[i] for i in used)
