"""Poses: matrices that files hold, turned to rotations with our axes, and moved between frames."""

from typing import Any

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.views import OPENGL
from industnerf.errors import BadArtifact

# of a rotation; files keep six digits or more, a millirad is a pixel at 1000 px
MAX_ORTHOGONALITY_ERROR = 1e-3
MIN_SCALE_DEVIATION = 1e-4  # an enlargement worth a word


def parse_pose(matrix: Any, frame_label: str) -> tuple[Float[np.ndarray, "4 4"], float]:
    """c2w in OpenCV axes, and the scale that its rotation carried.

    A scale changes the length of the camera's axes, hence no ray and no position: it is dropped.
    What is left is replaced by the nearest rotation.  Raises BadArtifact if the matrix is not
    4 x 4 or 3 x 4 and finite, mirrors, or is off a rotation by more than MAX_ORTHOGONALITY_ERROR.
    """
    label = f"{frame_label}: transform_matrix"
    c2w = matrix_4x4(matrix, label)
    c2w[:3, :3], scale = nearest_rotation(c2w[:3, :3], frame_label, "transform_matrix")
    return c2w @ OPENGL, scale


def nearest_rotation(
    axes: Float[np.ndarray, "3 3"], frame_label: str, name: str
) -> tuple[Float[np.ndarray, "3 3"], float]:
    """The rotation nearest to `axes`, and the scale that they carried; BadArtifact as above."""
    determinant = float(np.linalg.det(axes))
    if determinant <= 0:
        problem = "mirrors space" if determinant < 0 else "is flat"
        raise BadArtifact(f"{frame_label}: the rotation of {name} {problem} ({determinant:.3g})")
    scale = determinant ** (1 / 3)
    rotation = axes / scale
    error = float(np.abs(rotation.T @ rotation - np.eye(3)).max())
    if error > MAX_ORTHOGONALITY_ERROR:
        raise BadArtifact(
            f"{frame_label}: the first three columns of {name} are no rotation: "
            f"off by {error:.2g}, at most {MAX_ORTHOGONALITY_ERROR:g} is rounding"
        )
    u, _, vt = np.linalg.svd(rotation)
    return u @ vt, scale


def move_pose(
    c2w: Float[np.ndarray, "4 4"], similarity: Float[np.ndarray, "4 4"], label: str
) -> Float[np.ndarray, "4 4"]:
    """`c2w` in the frame to which `similarity` takes points; raises BadArtifact if it is none."""
    rotation, _ = nearest_rotation(similarity[:3, :3], label, "the frame's change")
    moved = c2w.copy()
    moved[:3, :3] = rotation @ c2w[:3, :3]
    moved[:3, 3] = similarity[:3, :3] @ c2w[:3, 3] + similarity[:3, 3]
    return moved


def matrix_4x4(matrix: Any, label: str) -> Float[np.ndarray, "4 4"]:
    """`matrix` as numbers; where it has three rows, the last, 0 0 0 1, goes without saying.

    Raises BadArtifact that begins with `label` if it is of another shape, or not finite.
    """
    try:
        c2w = np.array(matrix, float)
    except (TypeError, ValueError):
        raise BadArtifact(f"{label} is no matrix of numbers") from None
    except OverflowError:  # JSON's whole numbers have no end
        frame_label, _, name = label.rpartition(": ")
        raise BadArtifact(f"{frame_label}: a number of {name} is above 1e308") from None
    if c2w.shape == (3, 4):
        c2w = np.vstack([c2w, [0.0, 0.0, 0.0, 1.0]])
    if c2w.shape != (4, 4):
        raise BadArtifact(f"{label} has shape {c2w.shape}, must be (4, 4) or (3, 4)")
    if not np.isfinite(c2w).all():
        raise BadArtifact(f"{label} is not finite")
    if np.abs(c2w[3] - [0, 0, 0, 1]).max() > 1e-6:
        frame_label, _, name = label.rpartition(": ")
        raise BadArtifact(
            f"{frame_label}: the last row of {name} is {c2w[3].tolist()}, must be 0 0 0 1"
        )
    return c2w
