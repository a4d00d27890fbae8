"""The suite's world has z up.  A file whose standard or own words say otherwise is turned.

Each turn is a rotation, never a mirror image, and keeps the right-hand side that the format names
on +x.  Formats that say nothing of it (STL, OBJ, PLY, STEP, 3MF, ...) stay as they are.
"""

import numpy as np
from jaxtyping import Float64


def _rotation(rows: list[list[int]]) -> Float64[np.ndarray, "4 4"]:
    """`rows` are the axes x, y, z of the suite's world, in the axes of the file."""
    matrix = np.eye(4)
    matrix[:3, :3] = rows
    return matrix


X_UP = _rotation([[0, -1, 0], [0, 0, -1], [1, 0, 0]])
Y_UP = _rotation([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
Z_UP = np.eye(4)
COLLADA_UP_AXES = {
    "X_UP": X_UP,
    "Y_UP": Y_UP,
    "Z_UP": Z_UP,
}  # Y_UP is what the standard takes for silence
