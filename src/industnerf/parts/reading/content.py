"""What a reader of one format hands over, before units and finishes are settled.

Colours are linear albedos.  Most files state sRGB, which `paint.linear` turns into it; glTF states
linear factors.  An albedo of NaN means that the file states none.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.errors import BadPart


@dataclass(frozen=True)
class Body:
    """One body, in the unit of its file."""

    name: str
    vertices: Float64[np.ndarray, "n 3"]
    faces: Int64[np.ndarray, "m 3"]  # counter-clockwise from outside, as far as the file knows
    albedo: Float64[np.ndarray, "m 3"]  # of each face; NaN where none is stated


@dataclass(frozen=True)
class Content:
    """All bodies of a file."""

    bodies: tuple[Body, ...]
    scale: float | None  # mm in one unit of the coordinates; None: the file states no unit
    unit: str | None  # the unit that the file states, for people
    single: bool  # the file keeps coordinates as 32-bit numbers
    remarks: tuple[str, ...] = ()


def short(unit: str) -> str:
    """A unit as params.yaml would write it, however a format spells it."""
    known = {"in": "inch", "millimeter": "mm", "centimeter": "cm", "meter": "m"}
    unit = unit.lower().replace("metre", "meter")
    return known.get(unit, unit)


def unpainted(faces: int) -> Float64[np.ndarray, "m 3"]:
    """The albedo of `faces` faces of which the file states none."""
    return np.full((faces, 3), np.nan)


def joined(name: str, pieces: list[Body]) -> Body:
    """One body of several pieces; the pieces share no vertex."""
    first = np.cumsum([0] + [len(piece.vertices) for piece in pieces[:-1]])
    faces = [piece.faces + at for piece, at in zip(pieces, first, strict=True)]
    vertices = np.concatenate([piece.vertices for piece in pieces])
    return Body(name, vertices, np.concatenate(faces), np.concatenate([p.albedo for p in pieces]))


def placed(body: Body, matrix: Float64[np.ndarray, "4 4"], name: str) -> Body:
    """`body` moved by `matrix`; a mirror image keeps its outside outside."""
    vertices = body.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    mirrored = np.linalg.det(matrix[:3, :3]) < 0
    return Body(name, vertices, body.faces[:, ::-1] if mirrored else body.faces, body.albedo)


def require_indices(faces: Int64[np.ndarray, "m k"], vertices: int, what: str) -> None:
    """Raise BadPart if a face names a vertex that is not there."""
    wrong = np.flatnonzero(((faces < 0) | (faces >= vertices)).any(axis=1))
    if len(wrong):
        raise BadPart(
            f"{what}: {len(wrong)} of {len(faces)} faces name a vertex that is not there; face "
            f"{wrong[0] + 1} names {faces[wrong[0]].tolist()} of {vertices}"
        )
