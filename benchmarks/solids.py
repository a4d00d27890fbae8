"""What the benchmarks are run on."""

from collections.abc import Iterator

import numpy as np
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadArtifact
from industnerf.parts.catalogue.entries import load_catalogue_mesh, read_catalogue


def solids(names: list[str]) -> Iterator[tuple[str, Mesh]]:
    """The embedded parts `names`, or primitives and every so many-th embedded part."""
    try:
        entries = {entry.id: entry for entry in read_catalogue()}
    except BadArtifact:
        entries = {}
    if not names:
        yield "box", as_mesh(trimesh.creation.box((20, 30, 40)))
        yield "ball", as_mesh(trimesh.creation.icosphere(subdivisions=5))
        yield "ring", as_mesh(trimesh.creation.annulus(5, 10, 4, sections=128))
    for name in names or list(entries)[:: len(entries) // 7 + 1]:
        yield name, load_catalogue_mesh(entries[name])


def as_mesh(mesh: trimesh.Trimesh) -> Mesh:
    return Mesh.with_one_appearance(np.array(mesh.vertices, float), np.array(mesh.faces, np.int32))
