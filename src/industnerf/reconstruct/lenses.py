"""What transforms.json says of a lens: a pinhole's intrinsics in px, and how it bends lines."""

import math
from collections.abc import Mapping
from reprlib import repr as short  # of what may be nested or long without end
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
    `null` is as if nothing were said.
    """
    shared, own = _said(shared), _said(own)
    hushed = FOCAL if any(key in own for key in FOCAL) else ()
    return {key: value for key, value in shared.items() if key not in hushed} | own


def _said(words: Mapping[str, Any]) -> dict[str, Any]:
    return {key: words[key] for key in KEYS if words.get(key) is not None}


def distortion(lens: Mapping[str, Any], where: str) -> Distortion | None:
    """How the lens bends straight lines, or None if it does not.

    Raises BadArtifact for models other than OpenCV's of five coefficients.
    """
    remedy = "undistort the photographs first and give the pinhole cameras that belong to them"
    if lens.get("is_fisheye"):
        raise BadArtifact(f"{where}: is_fisheye: such lenses are not known here; {remedy}")
    model = lens.get("camera_model", "PINHOLE")
    known = isinstance(model, str) and model.upper() in MODELS
    if not known:
        raise BadArtifact(f"{where}: camera model {short(model)} is not known here; {remedy}")
    for key in UNKNOWN:
        if not _nought(lens.get(key, 0)):
            raise BadArtifact(f"{where}: {key} = {short(lens[key])} is not known here; {remedy}")
    bent = {key: _coefficient(lens, key, where) for key in BENT if key in lens}
    return Distortion(**bent) if any(bent.values()) else None


def _nought(value: Any) -> bool:
    """0, or a list of nothing else."""
    return all(each == 0 for each in value) if isinstance(value, list) else value == 0


def _coefficient(lens: Mapping[str, Any], key: str, where: str) -> float:
    value = _finite(lens[key])
    if value is None:
        raise BadArtifact(f"{where}: {key} is {short(lens[key])}, must be a number")
    return value


def _finite(value: Any) -> float | None:
    """`value` as a float; None if it is no number, or above all that a float can be."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:  # JSON's whole numbers have no end
        return None
    return number if math.isfinite(number) else None


def stated_size(lens: Mapping[str, Any], where: str) -> tuple[int, int] | None:
    """(width, height) in px for which the intrinsics hold, or None if the file is silent."""
    if "w" not in lens and "h" not in lens:
        return None
    return _whole(lens, "w", where), _whole(lens, "h", where)


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
    if angle >= math.pi or not math.tan(angle / 2):  # half of the least number is 0
        raise BadArtifact(
            f"{where}: camera_angle_{axis} is {angle:g}, must be radians above 0 and below pi"
        )
    return side / 2 / math.tan(angle / 2)


def _whole(lens: Mapping[str, Any], key: str, where: str) -> int:
    value = _number(lens, key, where)
    if not value.is_integer():
        said = short(lens[key])
        raise BadArtifact(f"{where}: {key} is {said}, must be a whole number of at least 1")
    return int(value)


def _number(lens: Mapping[str, Any], key: str, where: str) -> float:
    value = _finite(lens.get(key))
    if value is None or value <= 0:
        said = short(lens.get(key))
        raise BadArtifact(f"{where}: {key} is {said}, must be a number above 0, and finite")
    return value
