"""What transforms.json says of a lens: a pinhole's intrinsics in px, and how it bends lines."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import Float

from industnerf.errors import BadArtifact
from industnerf.reconstruct.distortion import Distortion

FOCAL = ("fl_x", "fl_y", "camera_angle_x", "camera_angle_y")
NUMBERS = (*FOCAL, "cx", "cy", "w", "h")
BENT = ("k1", "k2", "k3", "p1", "p2")
UNKNOWN = ("k4", "k5", "k6", "distortion_params")  # of other models, or in an order of its own
MODELS = ("OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "PERSPECTIVE", "SIMPLE_RADIAL", "RADIAL")
KEYS = (*NUMBERS, *BENT, *UNKNOWN, "camera_model", "is_fisheye")


def merged(shared: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """What is said of one frame's lens: its own words before those that all frames share.

    A frame that states a focal length in one way silences the shared one stated in another.
    """
    hushed = FOCAL if any(key in own for key in FOCAL) else ()
    lens = {key: shared[key] for key in KEYS if key in shared and key not in hushed}
    return lens | {key: own[key] for key in KEYS if key in own}


def distortion(lens: Mapping[str, Any], where: str) -> Distortion | None:
    """How the lens bends straight lines, or None if it does not.

    Raises BadArtifact for models other than OpenCV's of five coefficients.
    """
    remedy = "undistort the photographs first and give the pinhole cameras that belong to them"
    model = lens.get("camera_model", "PINHOLE")
    if lens.get("is_fisheye") or model not in MODELS:
        raise BadArtifact(f"{where}: camera model {model!r} is not known here; {remedy}")
    for key in UNKNOWN:
        if key in lens and np.any(np.asarray(lens[key]) != 0):
            raise BadArtifact(f"{where}: {key} = {lens[key]} is not known here; {remedy}")
    bent = {key: _coefficient(lens, key, where) for key in BENT if key in lens}
    return Distortion(**bent) if any(bent.values()) else None


def _coefficient(lens: Mapping[str, Any], key: str, where: str) -> float:
    value = lens[key]
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise BadArtifact(f"{where}: {key} is {value!r}, must be a number")
    return float(value)


def stated_size(lens: Mapping[str, Any], where: str) -> tuple[int, int] | None:
    """(width, height) in px for which the intrinsics hold, or None if the file is silent."""
    if "w" not in lens and "h" not in lens:
        return None
    width, height = _number(lens, "w", where), _number(lens, "h", where)
    return int(width), int(height)


def intrinsics(
    lens: Mapping[str, Any], width: int, height: int, where: str
) -> Float[np.ndarray, "3 3"]:
    """K for an image of `width` x `height` px; the principal point is its middle unless stated.

    A focal length goes before the angle of view.  Raises BadArtifact if neither is given, or the
    principal point is outside the image.
    """
    fx = _focal(lens, "x", width, where)
    fy = fx if {"fl_y", "camera_angle_y"}.isdisjoint(lens) else _focal(lens, "y", height, where)
    cx = _number(lens, "cx", where) if "cx" in lens else width / 2
    cy = _number(lens, "cy", where) if "cy" in lens else height / 2
    if not (cx < width and cy < height):
        raise BadArtifact(
            f"{where}: the principal point ({cx:g}, {cy:g}) is outside the image of {width} x "
            f"{height} px: the intrinsics belong to another size; state it as `w` and `h`"
        )
    return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]], float)


def _focal(lens: Mapping[str, Any], axis: str, side: int, where: str) -> float:
    if f"fl_{axis}" in lens:
        return _number(lens, f"fl_{axis}", where)
    if f"camera_angle_{axis}" not in lens:
        raise BadArtifact(f"{where}: neither fl_{axis} nor camera_angle_{axis} is given")
    angle = _number(lens, f"camera_angle_{axis}", where)
    if angle >= math.pi:
        raise BadArtifact(f"{where}: camera_angle_{axis} is {angle:g}, must be radians below pi")
    return side / 2 / math.tan(angle / 2)


def _number(lens: Mapping[str, Any], key: str, where: str) -> float:
    value = lens.get(key)
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not 0 < value < math.inf:
        raise BadArtifact(f"{where}: {key} is {value!r}, must be a number above 0")
    return float(value)
