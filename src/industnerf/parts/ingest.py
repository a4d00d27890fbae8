"""One embedded part, or one file of the user's, to a part folder."""

from pathlib import Path

import numpy as np

from industnerf.artifacts.part import Mesh, Part, save_part
from industnerf.geometry.raycast import Scene
from industnerf.geometry.sampling import sample_surface
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.geometry.visibility import seen_from
from industnerf.parts import checks
from industnerf.parts.catalogue import Entry, load
from industnerf.parts.clean import clean
from industnerf.parts.read import read_cad
from industnerf.seeds import generator

SAMPLES = 4096  # of the surface, for the visible share: a standard error below 0.8 %
EYES_AT = 2.0  # distance of the dense sphere of eyes, in diagonals
TOLERANCE = 1e-4  # how deep a sampled point may lie beneath the surface, in diagonals


def ingest_embedded(folder: Path, entry: Entry, target: Path, *, eyes: int, seed: int) -> None:
    """Write the part folder of a baked part; raises BadPart or BadArtifact if it is not sound."""
    vertices, faces = load(entry, folder)
    mesh = Mesh(vertices, faces)
    _save(target, mesh, entry, visible_share(mesh, eyes, seed, entry.id))


def _save(target: Path, mesh: Mesh, entry: Entry, share: float) -> None:
    part = Part(
        part_id=entry.id,
        family=entry.family,
        designation=entry.designation,
        origin="embedded",
        source=entry.library,
        extents_mm=entry.extents_mm,
        area_mm2=entry.area_mm2,
        volume_mm3=entry.volume_mm3,
        bodies=entry.bodies,
        faces=entry.faces,
        visible_share=share,
        defects=(),
    )
    save_part(target, part, mesh)


def ingest_file(
    path: Path,
    part_id: str,
    family: str,
    target: Path,
    *,
    units: str,
    weld: float,
    eyes: int,
    seed: int,
) -> None:
    """Write the part folder of a user's file; raises BadPart if no solid can be read from it."""
    vertices, faces = read_cad(path, units)
    mesh, defects = clean(vertices, faces, weld)
    closed = not len(checks.bad_edges(mesh.faces))
    part = Part(
        part_id=part_id,
        family=family,
        designation=path.name,
        origin="file",
        source=path.name,
        extents_mm=tuple(float(x) for x in checks.extents_mm(mesh.vertices)),
        area_mm2=checks.area_mm2(mesh.vertices, mesh.faces),
        volume_mm3=checks.volume_mm3(mesh.vertices, mesh.faces) if closed else None,
        bodies=checks.bodies(mesh.faces),
        faces=len(mesh.faces),
        visible_share=visible_share(mesh, eyes, seed, part_id),
        defects=defects,
    )
    save_part(target, part, mesh)


def visible_share(mesh: Mesh, eyes: int, seed: int, part_id: str) -> float:
    """Share of the area that at least one of `eyes` eyes on a sphere around the part sees."""
    rng = generator(seed, "visible share", part_id)
    points, _ = sample_surface(mesh.vertices, mesh.faces, SAMPLES, rng)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    diagonal = float(np.linalg.norm(high - low))
    around = (low + high) / 2 + EYES_AT * diagonal * fibonacci_sphere(eyes)
    scene = Scene(mesh.vertices, mesh.faces)
    return float(seen_from(scene, points, around, TOLERANCE * diagonal).mean())
