"""The points in an npz or npy file."""

import zipfile
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.external.cloud_content import CloudContent

ARRAY_NAMES = (
    "points_mm",
    "points",
)  # of the suite's stages, and of `industnerf.reconstruct --npz`
NUMERIC_KINDS = "iuf"  # kinds of dtypes that are real numbers
WRITE_HINT = "`np.savez(file, points_mm=points)` writes one"
OBJECTS = "is torn, or holds Python objects, which are not read"


def read_npz(file: Path) -> CloudContent:
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
            raise BadPart(f"{name} {OBJECTS}") from None
        colors, confidence = (arrays.get(key) for key in ("colors", "confidence"))
    points = _require_points(points, name)
    is_colored = colors is not None and colors.shape == points.shape and colors.dtype == np.uint8
    is_rated = confidence is not None and confidence.shape == points.shape[:1]
    return CloudContent(
        points,
        colors=colors if is_colored else None,
        confidence=_require_real(confidence, "confidence") if is_rated else None,
    )


def read_npy(file: Path) -> CloudContent:
    """The array of the npy `file`: its fields x, y and z, or else its first three columns.

    Raises BadPart if it has fewer, or is not of real numbers.
    """
    try:
        array = np.load(file, allow_pickle=False)
    except (ValueError, EOFError):
        raise BadPart(f"the array {OBJECTS}") from None
    if not isinstance(array, np.ndarray):
        raise BadPart("it is an npz, named .npy")
    if array.dtype.names and {"x", "y", "z"} <= set(array.dtype.names):
        array = np.stack([array[axis].ravel() for axis in "xyz"], axis=-1)
    width = array.shape[1] if array.ndim == 2 else 0
    points = _require_points(array[:, :3] if width > 3 else array, "the array")
    more = f"of its {width} columns the first three are taken as x, y, z"
    return CloudContent(points, (more,) if width > 3 else ())


def _require_points(array: np.ndarray, name: str) -> Float64[np.ndarray, "n 3"]:
    """As float64; raises BadPart for another shape, or anything but real numbers."""
    array = _require_real(array, name)
    if array.ndim != 2 or array.shape[1] != 3:
        raise BadPart(f"{name} is of shape {array.shape}, must be n x 3")
    return array


def _require_real(array: np.ndarray, name: str) -> np.ndarray:
    """As float64; raises BadPart for anything but real numbers."""
    if array.dtype.kind not in NUMERIC_KINDS:
        raise BadPart(f"{name} is of dtype {array.dtype}, must be of real numbers")
    return array.astype(np.float64)


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
