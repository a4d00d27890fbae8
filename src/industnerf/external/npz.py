"""The points in an npz file."""

import zipfile
from pathlib import Path

import numpy as np

from industnerf.errors import BadPart

ARRAY_NAMES = (
    "points_mm",
    "points",
)  # of the suite's stages, and of `industnerf.reconstruct --npz`
NUMERIC_KINDS = "iuf"  # kinds of dtypes that are real numbers
WRITE_HINT = "`np.savez(file, points_mm=points)` writes one"


def read_npz_points(file: Path) -> np.ndarray:
    """The first array of ARRAY_NAMES that the npz `file` holds, of whatever shape.

    Raises BadPart if it is no npz, has none of them, or one that is not of real numbers.
    """
    _require_npz(file)
    with np.load(file, allow_pickle=False) as arrays:
        name = next((name for name in ARRAY_NAMES if name in arrays), None)
        if name is None:
            raise BadPart(f"it holds none of {', '.join(ARRAY_NAMES)}, only {', '.join(arrays)}")
        try:
            points = np.asarray(arrays[name])
        except ValueError:  # numpy's advice would be to run whatever code is pickled in it
            raise BadPart(f"{name} is torn, or holds Python objects, which are not read") from None
    if points.dtype.kind not in NUMERIC_KINDS:
        raise BadPart(f"{name} is of dtype {points.dtype}, must be of real numbers")
    return points


def _require_npz(file: Path) -> None:
    with file.open("rb") as stream:
        start = stream.read(16)
    if start.startswith(b"\x93NUMPY"):
        raise BadPart(f"it is a .npy file, of a single array, and no npz; {WRITE_HINT}")
    if not start.startswith(b"PK"):
        description = f"it begins with {start!r}" if start else "it is empty (0 bytes)"
        raise BadPart(f"it is no npz: {description}; {WRITE_HINT}")
    if not zipfile.is_zipfile(file):
        raise BadPart("it begins as an npz and does not end as one: it is cut short")
