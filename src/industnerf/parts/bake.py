"""Mesh, check and write the parts of a set.

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
from industnerf.parts import checks
from industnerf.parts.catalogue import SCHEMA, Entry, digest
from industnerf.parts.cleaning.remains import seen_from_behind
from industnerf.parts.measure import measure
from industnerf.parts.sets import Drawable, drawable
from industnerf.runner import Outcome, Runner

PATIENCE_S = 300.0  # for one part; the slowest takes about 20 s


@dataclass(frozen=True)
class Baked:
    entry: Entry
    vertices: Float32[np.ndarray, "n 3"]
    faces: UInt[np.ndarray, "m 3"]
    finish: UInt8[np.ndarray, "m"]


def bake(family: str, recipe: Drawable) -> Baked:
    """Draw and mesh one part here and now.  Raises `BadPart` if the mesh is not sound."""
    drawn = recipe.meshed()
    stored = drawn.mesh.vertices.astype(np.float32)
    narrow = np.uint16 if len(stored) <= 1 << 16 else np.uint32
    # Everything below is said of the mesh as it is stored, after the rounding to float32.
    mesh = Mesh(stored.astype(np.float64), drawn.mesh.faces, drawn.mesh.finish)
    checks.require_sound(recipe.id, mesh.vertices, mesh.faces)
    entry = Entry(
        id=recipe.id,
        designation=recipe.designation,
        family=family,
        origin=recipe.origin,
        library=recipe.library,
        parameters=recipe.parameters,
        finishes=drawn.finishes,
        measured=measure(mesh),
        back_face_share=round(seen_from_behind(mesh), 6),
        reference=drawn.reference,
        reference_volume_mm3=round(drawn.reference_volume_mm3, 4),
        sha256=digest(stored, mesh.faces, mesh.finish),
    )
    _require_true(entry)
    return Baked(entry, stored, mesh.faces.astype(narrow), mesh.finish)


def _require_true(entry: Entry) -> None:
    if entry.back_face_share > checks.MOST_BACK_FACES:
        raise BadPart(
            f"part {entry.id!r} crosses itself: {entry.back_face_share:.2%} of the rays from "
            f"outside meet a face from behind, at most {checks.MOST_BACK_FACES:.2%} may. Draw it "
            "otherwise, or unite its solids as meshes (MeshBoolean)."
        )
    if abs(entry.volume_deviation) > checks.VOLUME_WITHIN:
        raise BadPart(
            f"part {entry.id!r}: the mesh's volume is {entry.volume_deviation:+.2%} off that of "
            f"the {entry.reference}, at most {checks.VOLUME_WITHIN:.2%} may be. Mesh it finer, or "
            "mend the drawing."
        )


def bake_all(name: str, part_ids: Sequence[str], drafts: Path, runner: Runner) -> Iterator[Outcome]:
    """Bake parts of the set `name` into the folder `drafts`; each outcome as it is known."""
    works = [partial(_bake_draft, name, part_id, drafts) for part_id in part_ids]
    return runner.map(works, PATIENCE_S)


def _bake_draft(name: str, part_id: str, drafts: Path) -> None:
    (drafts / part_id).write_bytes(pickle.dumps(bake(*drawable(name, part_id))))


def read_draft(drafts: Path, part_id: str) -> Baked:
    """What `bake_all` left; only ever called on a folder of this process's own."""
    return pickle.loads((drafts / part_id).read_bytes())


def write(baked: list[Baked], kept: list[Entry], folder: Path) -> None:
    """Write the meshes, and a catalogue of them and of the entries `kept` as they are.

    Any other mesh in `folder` goes.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for part in baked:
        _replace(folder / f"{part.entry.id}.npz", part)
    entries = [part.entry for part in baked] + kept
    ordered = sorted(entries, key=lambda entry: (entry.family, entry.id))
    rows = [dataclasses.asdict(entry) for entry in ordered]
    text = json.dumps({"schema": SCHEMA, "unit": "mm", "parts": rows}, indent=1) + "\n"
    write_text(folder / "catalogue.json", text)
    for path in folder.glob("*.npz"):
        if path.stem not in {entry.id for entry in entries}:
            path.unlink()


def _replace(path: Path, part: Baked) -> None:
    """Equal meshes give equal bytes: numpy writes no time stamp into the archive."""
    half_written = path.with_suffix(".tmp.npz")
    arrays = {"vertices": part.vertices, "faces": part.faces, "finish": part.finish}
    np.savez_compressed(half_written, **arrays)
    os.replace(half_written, path)
