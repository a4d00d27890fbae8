"""Mesh, check and write the parts of a catalogue.

Parts are drawn in child processes: the CAD kernel can hang or crash on one without taking the
others along.
"""

import dataclasses
import json
import os
import pickle
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Float32, UInt, UInt8

from industnerf.artifacts.files import write_text
from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.parts.catalogue.catalogues import PartRecipe, find_recipe
from industnerf.parts.catalogue.entries import SCHEMA, CatalogueEntry, mesh_digest
from industnerf.parts.measure import measure
from industnerf.parts.repair.defects import measure_back_face_share
from industnerf.parts.validation import checks
from industnerf.runner import Runner, WorkResult

TIMEOUT_S = 300.0  # for one part; the slowest takes about 20 s


@dataclass(frozen=True)
class BuiltPart:
    entry: CatalogueEntry
    vertices: Float32[np.ndarray, "n 3"]
    faces: UInt[np.ndarray, "m 3"]
    finish: UInt8[np.ndarray, "m"]


def build_part(family: str, recipe: PartRecipe) -> BuiltPart:
    """Draw and mesh one part here and now.  Raises `BadPart` if the mesh is not sound."""
    mesh_part = recipe.build_mesh()
    vertices32 = mesh_part.mesh.vertices.astype(np.float32)
    index_dtype = np.uint16 if len(vertices32) <= 1 << 16 else np.uint32
    # Everything below is said of the mesh as it is stored, after the rounding to float32.
    mesh = Mesh(vertices32.astype(np.float64), mesh_part.mesh.faces, mesh_part.mesh.finish)
    checks.require_watertight(recipe.id, mesh.vertices, mesh.faces)
    entry = CatalogueEntry(
        id=recipe.id,
        designation=recipe.designation,
        family=family,
        origin=recipe.origin,
        library=recipe.library,
        parameters=recipe.parameters,
        finishes=mesh_part.finishes,
        measured=measure(mesh),
        back_face_share=round(measure_back_face_share(mesh), 6),
        reference=mesh_part.reference,
        reference_volume_mm3=round(mesh_part.reference_volume_mm3, 4),
        sha256=mesh_digest(vertices32, mesh.faces, mesh.finish),
    )
    _require_within_tolerance(entry)
    return BuiltPart(entry, vertices32, mesh.faces.astype(index_dtype), mesh.finish)


def _require_within_tolerance(entry: CatalogueEntry) -> None:
    if entry.back_face_share > checks.MAX_BACK_FACE_SHARE:
        raise BadPart(
            f"part {entry.id!r} crosses itself: {entry.back_face_share:.2%} of the rays from "
            f"outside meet a face from behind, at most {checks.MAX_BACK_FACE_SHARE:.2%} may. Draw "
            "it otherwise, or unite its solids as meshes (MeshBoolean)."
        )
    if abs(entry.volume_deviation) > checks.VOLUME_TOLERANCE:
        raise BadPart(
            f"part {entry.id!r}: the mesh's volume is {entry.volume_deviation:+.2%} off that of "
            f"the {entry.reference}, at most {checks.VOLUME_TOLERANCE:.2%} may be. Mesh it finer, "
            "or correct the drawing."
        )


def build_parts(
    name: str, part_ids: Sequence[str], drafts: Path, runner: Runner
) -> Iterator[WorkResult]:
    """Build parts of the catalogue `name` into `drafts`; yields outcomes as they come."""
    works = [partial(_build_draft, name, part_id, drafts) for part_id in part_ids]
    return runner.map(works, TIMEOUT_S)


def _build_draft(name: str, part_id: str, drafts: Path) -> None:
    (drafts / part_id).write_bytes(pickle.dumps(build_part(*find_recipe(name, part_id))))


def read_draft(drafts: Path, part_id: str) -> BuiltPart:
    """What `build_parts` left; only ever called on a folder of this process's own."""
    return pickle.loads((drafts / part_id).read_bytes())


def write_catalogue(built: list[BuiltPart], unchanged: list[CatalogueEntry], folder: Path) -> None:
    """Write the meshes, and a catalogue of them and of the entries `unchanged` as they are.

    Any other mesh in `folder` goes.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for part in built:
        _write_mesh_file(folder / f"{part.entry.id}.npz", part)
    entries = [part.entry for part in built] + unchanged
    ordered = sorted(entries, key=lambda entry: (entry.family, entry.id))
    rows = [dataclasses.asdict(entry) for entry in ordered]
    text = json.dumps({"schema": SCHEMA, "unit": "mm", "parts": rows}, indent=1) + "\n"
    write_text(folder / "catalogue.json", text)
    for path in folder.glob("*.npz"):
        if path.stem not in {entry.id for entry in entries}:
            path.unlink()


def _write_mesh_file(path: Path, part: BuiltPart) -> None:
    """Equal meshes give equal bytes: numpy writes no time stamp into the archive."""
    temporary = path.with_suffix(".tmp.npz")
    arrays = {"vertices": part.vertices, "faces": part.faces, "finish": part.finish}
    np.savez_compressed(temporary, **arrays)
    os.replace(temporary, path)
