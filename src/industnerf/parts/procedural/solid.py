"""Procedural solids: the one of a seed and a number, whoever asks, in whatever order."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int32
from manifold3d import Manifold

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.errors import BadParams, BadPart
from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.parts.procedural.features import EmptyBody, extents
from industnerf.parts.procedural.finishes import draw_albedo
from industnerf.parts.procedural.kinds import DEFAULT_KINDS, KINDS, RESEMBLING_KINDS
from industnerf.parts.procedural.sampler import Sampler, on_grid
from industnerf.parts.validation.checks import extents_mm, volume_mm3
from industnerf.seeds import generator

MIN_THICKNESS = 0.02  # the shortest edge of the bounding box, of the longest
MIN_VOLUME = 3e-4  # of the cube about it
MIN_FACES, MAX_FACES = 20, 60_000  # fewer is a plain block, more costs too much to render
STRETCHED_SHARE, MAX_STRETCH = 0.3, 3.0  # along the axis it was drawn on: rods and plates
SMALLEST_DETAIL = 1e-4  # of the longest edge; what is smaller is smoothed away
MAX_DRAWS = 100


@dataclass(frozen=True)
class ProceduralSolid:
    """A closed solid in the unit cube: its bounding box is centered at 0, its longest edge is 1."""

    kind: str
    vertices: Float[np.ndarray, "n 3"]  # multiples of 2^-20
    faces: Int32[np.ndarray, "m 3"]  # counter-clockwise seen from outside
    albedo: tuple[float, float, float]  # linear

    def as_mesh(self, edge_mm: float = 1.0) -> tuple[Mesh, tuple[Appearance, ...]]:
        """As a part of the study is kept, its longest edge `edge_mm`, and its one finish."""
        mesh = Mesh.with_one_appearance(edge_mm * self.vertices, self.faces)
        return mesh, (Appearance(self.kind, self.albedo, 0.0, 0.5),)


def procedural_solid(
    seed: int, index: int, kinds: Sequence[str] = DEFAULT_KINDS
) -> ProceduralSolid:
    """Solid number `index` of `seed`; its kind is one of `kinds`, all as likely.

    It depends on these three alone: any range can be made in any order, by any process.  A draw
    that is no solid to learn from (too thin, too small, too plain, too fine) is drawn anew from
    the same stream.  Raises BadParams for a kind that does not exist, BadPart if no draw will do.
    """
    unknown = [kind for kind in kinds if kind not in KINDS]
    if unknown or not kinds:
        raise BadParams(f"procedural kinds {unknown or 'none'}: known are {', '.join(KINDS)}")
    kind = Sampler(generator(seed, "procedural kind", str(index))).pick(kinds)
    rng = Sampler(generator(seed, "procedural solid", str(index), kind))
    for _ in range(MAX_DRAWS):
        try:
            body = KINDS[kind](rng)
        except EmptyBody:
            continue
        if kind not in RESEMBLING_KINDS and rng.chance(STRETCHED_SHARE):
            body = body.scale([1, 1, rng.log_uniform(1 / MAX_STRETCH, MAX_STRETCH)])
        mesh = _unit_mesh(body, _orientation(rng))
        if mesh is not None:
            return ProceduralSolid(kind, *mesh, draw_albedo(rng))
    raise BadPart(f"procedural solid {index} of seed {seed}: {MAX_DRAWS} draws of {kind} failed")


def _unit_mesh(
    body: Manifold, orientation: Float[np.ndarray, "3 3"]
) -> tuple[Float[np.ndarray, "n 3"], Int32[np.ndarray, "m 3"]] | None:
    """Vertices and faces of its largest piece, turned, in the unit cube; None if it is refused."""
    if body.is_empty():
        return None
    low, high = extents(body)
    pieces = body.simplify(SMALLEST_DETAIL * float((high - low).max())).decompose()
    mesh = max(pieces, key=Manifold.volume).to_mesh64()
    faces = np.array(mesh.tri_verts, np.int32)
    if not MIN_FACES <= len(faces) <= MAX_FACES:
        return None
    vertices = np.array(mesh.vert_properties)[:, :3] @ orientation
    vertices = on_grid(BoundingCube.of(vertices).to_unit(vertices))
    if extents_mm(vertices).min() < MIN_THICKNESS or volume_mm3(vertices, faces) < MIN_VOLUME:
        return None
    return vertices, faces


def _orientation(rng: Sampler) -> Float[np.ndarray, "3 3"]:
    """One of the 24 turns of a cube onto itself."""
    turn = np.eye(3)[rng.order(3)] * [rng.sign(), rng.sign(), 1]
    return turn * [1, 1, round(np.linalg.det(turn))]


def digest(solids: Sequence[ProceduralSolid]) -> str:
    """SHA-256 of kinds, vertices, faces and finishes."""
    total = hashlib.sha256()
    for solid in solids:
        total.update(solid.kind.encode())
        for array in (solid.vertices, solid.faces, np.array(solid.albedo)):
            total.update(np.ascontiguousarray(array).tobytes())
    return total.hexdigest()
