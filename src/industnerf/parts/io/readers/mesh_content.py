"""What a reader of one format hands over, before units and finishes are settled.

Colors are linear albedos.  Most files state sRGB, which `srgb_to_linear` decodes; glTF states
linear factors.  An albedo of NaN means that the file states none.

The suite's world has z up.  Formats that name their up axis (glTF, COLLADA) are rotated, never
mirrored; all others stay as they are.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from industnerf.errors import BadPart

# From the axes of the file to those of the suite; the format's right-hand side goes to +x.
X_UP = np.array([[0.0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])
Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
Z_UP = np.eye(4)
WARN_STEP, MAX_STEP = 1e-4, 1e-2  # step of the coordinates, as a share of the diagonal


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
    is_in_mm: bool = False  # the reader has turned the file's numbers into mm
    num_points: int = 0  # of a file that has points and no face


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


def strip_triangles(order: Int64[np.ndarray, "k"]) -> Int64[np.ndarray, "t 3"]:
    """The triangles of a strip; every other one runs the other way."""
    i = np.arange(max(len(order) - 2, 0))
    odd = i % 2
    return np.stack([order[i], order[i + 1 + odd], order[i + 2 - odd]], axis=1)


def fan_triangles(order: Int64[np.ndarray, "k"]) -> Int64[np.ndarray, "t 3"]:
    """The triangles between the first corner of a fan and each two that follow."""
    i = np.arange(max(len(order) - 2, 0))
    return np.stack([order[0 * i], order[i + 1], order[i + 2]], axis=1)


def require_valid_indices(faces: Int64[np.ndarray, "m k"], vertices: int, label: str) -> None:
    """Raise BadPart if a face names a vertex that is not there."""
    bad = np.flatnonzero(((faces < 0) | (faces >= vertices)).any(axis=1))
    if len(bad):
        raise BadPart(
            f"{label}: {len(bad)} of {len(faces)} faces name a vertex that is not there; face "
            f"{bad[0] + 1} names {faces[bad[0]].tolist()} of {vertices}"
        )


def precision_warnings(bodies: tuple[MeshBody, ...]) -> tuple[str, ...]:
    """A warning if 32-bit coordinates step too coarsely; raises BadPart if the shape is lost.

    A float32 has 24 bits, so a part far from the origin loses the fine ones.  A step of 1e-4 of
    the diagonal, a fifth of the chord error of the embedded meshes, is visible.  At 1e-2 a vertex
    is off by as much as the F-score forgives.
    """
    points = np.concatenate([body.vertices for body in bodies])
    points = points[np.isfinite(points).all(axis=1)]
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 0.0
    if diagonal == 0:
        return ()  # no solid anyway, which the repair says
    largest = float(np.abs(points).max())
    share = float(np.spacing(np.float32(largest))) / diagonal
    message = (
        f"its 32-bit coordinates reach {largest:.3g}, where they step by {share:.2g} of the part's "
        "diagonal"
    )
    if share > MAX_STEP:
        raise BadPart(f"{message}: the shape is lost; export it near the origin")
    return (message,) if share > WARN_STEP else ()
