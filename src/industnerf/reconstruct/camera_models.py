"""Intrinsics and lens distortion of transforms.json, and photographs as a pinhole would take them.

The model is OpenCV's, with which COLMAP and what writes transforms.json calibrate: a ray (x, y, 1)
of the camera meets the image where a pinhole would have that of

    x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
    y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y,       r^2 = x^2 + y^2
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from reprlib import repr as short  # of what may be nested or long without end
from typing import Any

import numpy as np
from jaxtyping import Float, UInt8
from scipy.ndimage import map_coordinates

from industnerf.errors import BadArtifact

ZOOM_RANGE = (0.5, 4.0)  # a lens that needs another is no photograph's
BISECTION_STEPS = 24  # of that interval: to 1e-7 of a focal length
EDGE_SAMPLES = np.linspace(0, 1, 65)  # points of each side of the image that are asked


@dataclass(frozen=True)
class Distortion:
    """OpenCV's five coefficients of a lens that bends straight lines."""

    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    p1: float = 0.0
    p2: float = 0.0

    def distort(self, xy: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        """Where the rays (x, y, 1) meet the image, in focal lengths from its principal point."""
        x, y = xy[..., 0], xy[..., 1]
        r2 = x * x + y * y
        radial = 1 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3))
        tangential_y = self.p1 * (r2 + 2 * y * y) + 2 * self.p2 * x * y
        tangential_x = 2 * self.p1 * x * y + self.p2 * (r2 + 2 * x * x)
        return np.stack([x * radial + tangential_x, y * radial + tangential_y], axis=-1)

    def has_folds(self, radius: float) -> bool:
        """Whether, within `radius`, rays farther out meet the image farther in."""
        r2 = np.linspace(0, radius, 257) ** 2
        radial_derivative = 1 + r2 * (3 * self.k1 + r2 * (5 * self.k2 + r2 * 7 * self.k3))
        return bool((radial_derivative <= 0).any())


def undistort(
    image: UInt8[np.ndarray, "h w channels"],
    K: Float[np.ndarray, "3 3"],
    distortion: Distortion,
    frame_label: str,
) -> tuple[UInt8[np.ndarray, "h w channels"], Float[np.ndarray, "3 3"]]:
    """`image` as a pinhole had taken it, and the pinhole's K.

    Of the same size, and enlarged just so much that no pixel lies beyond the edge of the
    photograph.  Colors are interpolated linearly.  Raises BadArtifact that names the frame if
    there is no such image.
    """
    height, width = image.shape[:2]
    pinhole_K = K.copy()
    pinhole_K[[0, 1], [0, 1]] *= _min_zoom(K, distortion, width, height, frame_label)
    column, row = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    source_px = _distorted_pixels(np.stack([column, row], axis=-1), pinhole_K, K, distortion) - 0.5
    coordinates = [source_px[..., 1], source_px[..., 0]]
    channels = [
        map_coordinates(image[..., channel], coordinates, np.float32, order=1, mode="nearest")
        for channel in range(image.shape[2])
    ]
    return np.rint(np.stack(channels, axis=-1)).astype(np.uint8), pinhole_K


def _distorted_pixels(
    px: Float[np.ndarray, "... 2"],
    pinhole_K: Float[np.ndarray, "3 3"],
    K: Float[np.ndarray, "3 3"],
    distortion: Distortion,
) -> Float[np.ndarray, "... 2"]:
    """Where the photograph shows what the pinhole of `pinhole_K` would show at `px`."""
    principal_point, focal = K[:2, 2], K[[0, 1], [0, 1]]
    return principal_point + focal * distortion.distort(
        (px - principal_point) / pinhole_K[[0, 1], [0, 1]]
    )


def _min_zoom(
    K: Float[np.ndarray, "3 3"], distortion: Distortion, width: int, height: int, frame_label: str
):
    """The least by which the focal lengths must grow, for no pixel to be missing."""
    size = np.array([width, height], float)
    sides = [
        np.stack([EDGE_SAMPLES, np.full_like(EDGE_SAMPLES, edge)], axis=1) for edge in (0.0, 1.0)
    ]
    border = size * np.concatenate([*sides, *(side[:, ::-1] for side in sides)])

    def is_complete(zoom: float) -> bool:
        pinhole_K = K.copy()
        pinhole_K[[0, 1], [0, 1]] *= zoom
        rays = (border - K[:2, 2]) / pinhole_K[[0, 1], [0, 1]]
        source_px = _distorted_pixels(border, pinhole_K, K, distortion)
        is_inside = bool(((source_px >= 0) & (source_px <= size)).all())
        return is_inside and not distortion.has_folds(float(np.linalg.norm(rays, axis=1).max()))

    low, high = ZOOM_RANGE
    if not is_complete(high):
        raise BadArtifact(
            f"{frame_label}: {distortion} cannot be undone: not even the middle of the image is "
            "straightened by it; are these the coefficients of this lens?"
        )
    for _ in range(BISECTION_STEPS):
        middle = (low + high) / 2
        low, high = (low, middle) if is_complete(middle) else (middle, high)
    return high


FOCAL_KEYS = ("fl_x", "fl_y", "camera_angle_x", "camera_angle_y")
INTRINSIC_KEYS = (*FOCAL_KEYS, "cx", "cy", "w", "h")
DISTORTION_KEYS = ("k1", "k2", "k3", "p1", "p2")
# of other models, or in an order of its own
UNSUPPORTED_KEYS = ("k4", "k5", "k6", "distortion_params")
SUPPORTED_MODELS = ("OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "PERSPECTIVE", "SIMPLE_RADIAL", "RADIAL")
CAMERA_KEYS = (*INTRINSIC_KEYS, *DISTORTION_KEYS, *UNSUPPORTED_KEYS, "camera_model", "is_fisheye")


def merge_camera_params(shared: Mapping[str, Any], per_frame: Mapping[str, Any]) -> dict[str, Any]:
    """Camera parameters of one frame: its own before those that all frames share.

    A focal length of the frame, stated in whichever way, overrides the shared one.  `null` counts
    as not stated.
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
            f"{frame_label}: the principal point ({cx:g}, {cy:g}) is outside the image of "
            f"{width} x {height} px: the intrinsics belong to another size; state it as `w` and `h`"
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
