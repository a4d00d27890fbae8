"""Draw, mesh, check and write the embedded parts.  Needs the `[cad]` extra.

Parts are drawn in child processes: the CAD kernel can hang or crash on one without taking the
others along.
"""

import dataclasses
import json
import multiprocessing
import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from queue import SimpleQueue

import numpy as np
from jaxtyping import Float32, UInt

from industnerf.errors import BadPart
from industnerf.geometry.raycast import Scene
from industnerf.parts import checks
from industnerf.parts.catalogue import SCHEMA, Entry, digest
from industnerf.parts.families import FAMILIES
from industnerf.parts.recipe import Recipe
from industnerf.parts.tessellate import tessellate

PATIENCE_S = 300.0  # for one part; the slowest takes about 20 s


@dataclass(frozen=True)
class Baked:
    entry: Entry
    vertices: Float32[np.ndarray, "n 3"]
    faces: UInt[np.ndarray, "m 3"]


@dataclass(frozen=True)
class Outcome:
    part_id: str
    answer: Baked | str  # or else why not


def bake(family: str, recipe: Recipe) -> Baked:
    """Draw and mesh one part here and now.  Raises `BadPart` if the mesh is not sound."""
    mesh = tessellate(recipe.shape())
    stored = mesh.vertices.astype(np.float32)
    narrow = np.uint16 if len(stored) <= 1 << 16 else np.uint32
    # Everything below is said of the mesh as it is stored, after the rounding to float32.
    vertices, faces = stored.astype(np.float64), mesh.faces
    checks.require_sound(recipe.id, vertices, faces)
    scene = Scene(vertices, faces)
    behind = checks.back_face_share(
        vertices, faces, lambda origins, directions: scene.cast(origins, directions).face
    )
    if behind > checks.MOST_BACK_FACES:
        raise BadPart(
            f"part {recipe.id!r} crosses itself: {behind:.2%} of the rays from outside meet a "
            f"face from behind, at most {checks.MOST_BACK_FACES:.2%} may. Draw it otherwise, or "
            "unite its solids as meshes (MeshBoolean)."
        )
    volume = checks.volume_mm3(vertices, faces)
    exact = mesh.brep_volume_mm3
    x, y, z = (round(float(side), 4) for side in checks.extents_mm(vertices))
    entry = Entry(
        id=recipe.id,
        designation=recipe.designation,
        family=family,
        library=recipe.library,
        parameters=recipe.parameters,
        volume_mm3=round(volume, 4),
        area_mm2=round(checks.area_mm2(vertices, faces), 4),
        extents_mm=(x, y, z),
        faces=len(faces),
        bodies=checks.bodies(faces),
        back_face_share=round(behind, 6),
        brep_volume_mm3=None if exact is None else round(exact, 4),
        volume_deviation=None if exact is None else round(volume / exact - 1, 6),
        sha256=digest(stored, faces),
    )
    return Baked(entry, stored, faces.astype(narrow))


def bake_all(parts: list[tuple[str, Recipe]], workers: int) -> Iterator[Outcome]:
    """Bake every (family, recipe), `workers` at a time, in the order in which they finish."""
    idle: SimpleQueue[Workshop] = SimpleQueue()
    for _ in range(workers):
        idle.put(Workshop())

    def bake_in_turn(family: str, recipe: Recipe) -> Outcome:
        workshop = idle.get()
        answer = workshop.bake(family, recipe.id)
        idle.put(workshop if workshop.process.is_alive() else Workshop())
        return Outcome(recipe.id, answer)

    with ThreadPoolExecutor(workers) as lanes:
        waiting = [lanes.submit(bake_in_turn, family, recipe) for family, recipe in parts]
        for done in as_completed(waiting):
            yield done.result()


class Workshop:
    """A child process that bakes part after part until it crashes or hangs.

    Spawned, never forked: the CAD kernel starts threads when it is imported, and a fork of it
    waits for them forever.  That import takes seconds, hence one child for many parts.
    """

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.wire, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs,), daemon=True)
        self.process.start()
        theirs.close()

    def bake(self, family: str, part_id: str) -> Baked | str:
        """The baked part, or why there is none; in the worst case the process is dead after it."""
        try:
            self.wire.send((family, part_id))
            if self.wire.poll(PATIENCE_S):
                return self.wire.recv()
        except (EOFError, OSError):
            self.process.join()
            return f"its process died with exit code {self.process.exitcode}"
        self.process.kill()
        self.process.join()
        return f"not done after {PATIENCE_S:.0f} s"


def _serve(wire: Connection) -> None:
    while True:
        try:
            family, part_id = wire.recv()
        except EOFError:  # the parent has closed the wire
            return
        (recipe,) = (recipe for recipe in FAMILIES[family] if recipe.id == part_id)
        try:
            wire.send(bake(family, recipe))
        except Exception as error:  # the CAD kernel raises anything; the parent lists it
            wire.send(f"{type(error).__name__}: {error}")


def write(baked: list[Baked], kept: list[Entry], folder: Path) -> None:
    """Write the meshes, and a catalogue of them and of the entries `kept` as they are.

    Any other mesh in `folder` goes.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for part in baked:
        _replace(folder / f"{part.entry.id}.npz", part)
    entries = [part.entry for part in baked] + kept
    for path in folder.glob("*.npz"):
        if path.stem not in {entry.id for entry in entries}:
            path.unlink()
    ordered = sorted(entries, key=lambda entry: (entry.family, entry.id))
    rows = [dataclasses.asdict(entry) for entry in ordered]
    text = json.dumps({"schema": SCHEMA, "unit": "mm", "parts": rows}, indent=1) + "\n"
    (folder / "catalogue.json").write_text(text, encoding="utf-8")


def _replace(path: Path, part: Baked) -> None:
    """Equal meshes give equal bytes: numpy writes no time stamp into the archive."""
    half_written = path.with_suffix(".tmp.npz")
    np.savez_compressed(half_written, vertices=part.vertices, faces=part.faces)
    os.replace(half_written, path)
