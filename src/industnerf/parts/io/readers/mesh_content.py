"""What a reader of one format hands over, before units and finishes are settled.

Colors are linear albedos.  Most files state sRGB, which `paint.linear` turns into it; glTF states
linear factors.  An albedo of NaN means that the file states none.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.errors import BadPart


@dataclass(frozen=True)
class MeshBody:
    """One body, in the unit of its file."""

    name: str
    vertices: Float64[np.ndarray, "n 3"]
    faces: Int64[np.ndarray, "m 3"]  # counter-clockwise from outside, as far as the file knows
    albedo: Float64[np.ndarray, "m 3"]  # of each face; NaN where none is stated


@dataclass(frozen=True)
class MeshContent:
    """All bodies of a file."""

    bodies: tuple[MeshBody, ...]
    scale: float | None  # mm in one unit of the coordinates; None: the file states no unit
    unit: str | None  # the unit that the file states, for people
    is_float32: bool  # the file keeps coordinates as 32-bit numbers
    warnings: tuple[str, ...] = ()


def normalize_unit(unit: str) -> str:
    """A unit as params.yaml would write it, however a format spells it."""
    aliases = {"in": "inch", "millimeter": "mm", "centimeter": "cm", "meter": "m"}
    unit = unit.lower().replace("metre", "meter")
    return aliases.get(unit, unit)


def unstated_albedo(faces: int) -> Float64[np.ndarray, "m 3"]:
    """The albedo of `faces` faces of which the file states none."""
    return np.full((faces, 3), np.nan)


def concatenate_bodies(name: str, pieces: list[MeshBody]) -> MeshBody:
    """One body of several pieces; the pieces share no vertex."""
    first = np.cumsum([0] + [len(piece.vertices) for piece in pieces[:-1]])
    faces = [piece.faces + offset for piece, offset in zip(pieces, first, strict=True)]
    vertices = np.concatenate([piece.vertices for piece in pieces])
    return MeshBody(
        name, vertices, np.concatenate(faces), np.concatenate([p.albedo for p in pieces])
    )


def transform_body(body: MeshBody, matrix: Float64[np.ndarray, "4 4"], name: str) -> MeshBody:
    """`body` moved by `matrix`; a mirror image keeps its outside outside."""
    vertices = body.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    is_mirrored = np.linalg.det(matrix[:3, :3]) < 0
    return MeshBody(name, vertices, body.faces[:, ::-1] if is_mirrored else body.faces, body.albedo)


def require_valid_indices(faces: Int64[np.ndarray, "m k"], vertices: int, label: str) -> None:
    """Raise BadPart if a face names a vertex that is not there."""
    bad = np.flatnonzero(((faces < 0) | (faces >= vertices)).any(axis=1))
    if len(bad):
        raise BadPart(
            f"{label}: {len(bad)} of {len(faces)} faces name a vertex that is not there; face "
            f"{bad[0] + 1} names {faces[bad[0]].tolist()} of {vertices}"
        )
