"""Camera-to-world matrices of transforms.json, checked and turned to our axes."""

from typing import Any

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.views import OPENGL
from industnerf.errors import BadArtifact

MAX_ORTHOGONALITY_ERROR = (
    1e-3  # of a rotation; files keep six digits or more, a millirad is a pixel at 1000 px
)
MIN_SCALE_DEVIATION = 1e-4  # an enlargement worth a word


def parse_pose(matrix: Any, frame_label: str) -> tuple[Float[np.ndarray, "4 4"], float]:
    """c2w in OpenCV axes, and the scale that its rotation carried.

    A scale changes the length of the camera's axes, hence no ray and no position: it is dropped.
    What is left is replaced by the nearest rotation.  Raises BadArtifact if the matrix is not
    4 x 4 and finite, mirrors, or is off a rotation by more than `SKEWED`.
    """
    c2w = _parse_matrix(matrix, frame_label)
    rotation = c2w[:3, :3]
    determinant = float(np.linalg.det(rotation))
    if determinant <= 0:
        problem = "mirrors space" if determinant < 0 else "is flat"
        raise BadArtifact(
            f"{frame_label}: the rotation of transform_matrix {problem} ({determinant:.3g})"
        )
    scale = determinant ** (1 / 3)
    rotation = rotation / scale
    error = float(np.abs(rotation.T @ rotation - np.eye(3)).max())
    if error > MAX_ORTHOGONALITY_ERROR:
        raise BadArtifact(
            f"{frame_label}: the first three columns of transform_matrix are no rotation: "
            f"off by {error:.2g}, at most {MAX_ORTHOGONALITY_ERROR:g} is rounding"
        )
    u, _, vt = np.linalg.svd(rotation)
    c2w[:3, :3] = u @ vt
    return c2w @ OPENGL, scale


def _parse_matrix(matrix: Any, frame_label: str) -> Float[np.ndarray, "4 4"]:
    try:
        c2w = np.array(matrix, float)
    except (TypeError, ValueError):
        raise BadArtifact(f"{frame_label}: transform_matrix is no matrix of numbers") from None
    except OverflowError:  # JSON's whole numbers have no end
        raise BadArtifact(f"{frame_label}: a number of transform_matrix is above 1e308") from None
    if c2w.shape != (4, 4):
        raise BadArtifact(f"{frame_label}: transform_matrix has shape {c2w.shape}, must be (4, 4)")
    if not np.isfinite(c2w).all():
        raise BadArtifact(f"{frame_label}: transform_matrix is not finite")
    if np.abs(c2w[3] - [0, 0, 0, 1]).max() > 1e-6:
        raise BadArtifact(
            f"{frame_label}: the last row of transform_matrix is {c2w[3].tolist()}, must be 0 0 0 1"
        )
    return c2w
