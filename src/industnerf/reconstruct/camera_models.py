"""What transforms.json says of a lens: a pinhole's intrinsics in px, and how it bends lines."""

import math
from collections.abc import Mapping
from reprlib import repr as short  # of what may be nested or long without end
from typing import Any

import numpy as np
from jaxtyping import Float

from industnerf.errors import BadArtifact
from industnerf.reconstruct.distortion import Distortion

FOCAL_KEYS = ("fl_x", "fl_y", "camera_angle_x", "camera_angle_y")
INTRINSIC_KEYS = (*FOCAL_KEYS, "cx", "cy", "w", "h")
DISTORTION_KEYS = ("k1", "k2", "k3", "p1", "p2")
UNSUPPORTED_KEYS = (
    "k4",
    "k5",
    "k6",
    "distortion_params",
)  # of other models, or in an order of its own
SUPPORTED_MODELS = ("OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "PERSPECTIVE", "SIMPLE_RADIAL", "RADIAL")
CAMERA_KEYS = (*INTRINSIC_KEYS, *DISTORTION_KEYS, *UNSUPPORTED_KEYS, "camera_model", "is_fisheye")


def merge_camera_params(shared: Mapping[str, Any], per_frame: Mapping[str, Any]) -> dict[str, Any]:
    """What is said of one frame's lens: its own words before those that all frames share.

    A frame that states a focal length in one way silences the shared one stated in another.
    `null` is as if nothing were said.
    """
    shared, per_frame = _stated(shared), _stated(per_frame)
    overridden = FOCAL_KEYS if any(key in per_frame for key in FOCAL_KEYS) else ()
    return {key: value for key, value in shared.items() if key not in overridden} | per_frame


def _stated(values: Mapping[str, Any]) -> dict[str, Any]:
    return {key: values[key] for key in CAMERA_KEYS if values.get(key) is not None}


def parse_distortion(camera_params: Mapping[str, Any], frame_label: str) -> Distortion | None:
    """How the lens bends straight lines, or None if it does not.

    Raises BadArtifact for models other than OpenCV's of five coefficients.
    """
    remedy = "undistort the photographs first and give the pinhole cameras that belong to them"
    if camera_params.get("is_fisheye"):
        raise BadArtifact(f"{frame_label}: is_fisheye: such lenses are not known here; {remedy}")
    model = camera_params.get("camera_model", "PINHOLE")
    is_supported = isinstance(model, str) and model.upper() in SUPPORTED_MODELS
    if not is_supported:
        raise BadArtifact(f"{frame_label}: camera model {short(model)} is not known here; {remedy}")
    for key in UNSUPPORTED_KEYS:
        if not _is_zero(camera_params.get(key, 0)):
            raise BadArtifact(
                f"{frame_label}: {key} = {short(camera_params[key])} is not known here; {remedy}"
            )
    coefficients = {
        key: _parse_coefficient(camera_params, key, frame_label)
        for key in DISTORTION_KEYS
        if key in camera_params
    }
    return Distortion(**coefficients) if any(coefficients.values()) else None


def _is_zero(value: Any) -> bool:
    """0, or a list of nothing else."""
    return all(item == 0 for item in value) if isinstance(value, list) else value == 0


def _parse_coefficient(camera_params: Mapping[str, Any], key: str, frame_label: str) -> float:
    value = _to_finite_float(camera_params[key])
    if value is None:
        raise BadArtifact(f"{frame_label}: {key} is {short(camera_params[key])}, must be a number")
    return value


def _to_finite_float(value: Any) -> float | None:
    """`value` as a float; None if it is no number, or above all that a float can be."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:  # JSON's whole numbers have no end
        return None
    return number if math.isfinite(number) else None


def image_size(camera_params: Mapping[str, Any], frame_label: str) -> tuple[int, int] | None:
    """(width, height) in px for which the intrinsics hold, or None if the file is silent."""
    if "w" not in camera_params and "h" not in camera_params:
        return None
    return _positive_int(camera_params, "w", frame_label), _positive_int(
        camera_params, "h", frame_label
    )


def intrinsics(
    camera_params: Mapping[str, Any], width: int, height: int, frame_label: str
) -> Float[np.ndarray, "3 3"]:
    """K for an image of `width` x `height` px; the principal point is its middle unless stated.

    A focal length goes before the angle of view.  Raises BadArtifact if neither is given, or the
    principal point is outside the image.
    """
    fx = _focal_length(camera_params, "x", width, frame_label)
    fy = (
        fx
        if {"fl_y", "camera_angle_y"}.isdisjoint(camera_params)
        else _focal_length(camera_params, "y", height, frame_label)
    )
    cx = _positive_float(camera_params, "cx", frame_label) if "cx" in camera_params else width / 2
    cy = _positive_float(camera_params, "cy", frame_label) if "cy" in camera_params else height / 2
    if not (cx < width and cy < height):
        raise BadArtifact(
            f"{frame_label}: the principal point ({cx:g}, {cy:g}) is outside the image of {width} x "
            f"{height} px: the intrinsics belong to another size; state it as `w` and `h`"
        )
    return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]], float)


def _focal_length(
    camera_params: Mapping[str, Any], axis: str, size_px: int, frame_label: str
) -> float:
    if f"fl_{axis}" in camera_params:
        return _positive_float(camera_params, f"fl_{axis}", frame_label)
    if f"camera_angle_{axis}" not in camera_params:
        raise BadArtifact(f"{frame_label}: neither fl_{axis} nor camera_angle_{axis} is given")
    angle = _positive_float(camera_params, f"camera_angle_{axis}", frame_label)
    if angle >= math.pi or not math.tan(angle / 2):  # half of the least number is 0
        raise BadArtifact(
            f"{frame_label}: camera_angle_{axis} is {angle:g}, must be radians above 0 and below pi"
        )
    return size_px / 2 / math.tan(angle / 2)


def _positive_int(camera_params: Mapping[str, Any], key: str, frame_label: str) -> int:
    value = _positive_float(camera_params, key, frame_label)
    if not value.is_integer():
        value_text = short(camera_params[key])
        raise BadArtifact(
            f"{frame_label}: {key} is {value_text}, must be a whole number of at least 1"
        )
    return int(value)


def _positive_float(camera_params: Mapping[str, Any], key: str, frame_label: str) -> float:
    value = _to_finite_float(camera_params.get(key))
    if value is None or value <= 0:
        value_text = short(camera_params.get(key))
        raise BadArtifact(
            f"{frame_label}: {key} is {value_text}, must be a number above 0, and finite"
        )
    return value
