"""What can be right and seldom is: a sentence each, as a cloud would come out all the same."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, UInt8

from industnerf.geometry.silhouettes import border
from industnerf.reconstruct.views import View

MAX_BACKGROUND_DIFFERENCE = 255 / 8  # in a channel: more than light that falls off, or compression
BLACK_THRESHOLD = 255 / 8  # 12 bits of 16 end at 255 / 16
MAX_FOV_DEG, MIN_FOV_DEG = 120.0, 1.0  # degrees; beyond, a pinhole camera is a slip


def input_warnings(views: Sequence[View], background: Float[np.ndarray, "3"] | None) -> list[str]:
    """Sentences on `views`; `background` (sRGB in [0, 1]) is what the user said of it, if any."""
    warnings = [
        _background_warning(views, background),
        _field_of_view_warning(views),
        _dark_image_warning(views),
    ]
    return [warning for warning in warnings if warning]


def _background_warning(
    views: Sequence[View], background: Float[np.ndarray, "3"] | None
) -> str | None:
    """Where a photograph is see-through it shows `background`, so is not unlike it."""
    if background is None:
        return None
    borders = [border(view.rgb) for view in views]
    mismatched = [
        border_pixels for border_pixels in borders if _differs_from(border_pixels, 255 * background)
    ]
    if not mismatched:
        return None
    color = np.median(np.concatenate(mismatched), axis=0)
    return (
        f"{len(mismatched)} of {len(views)} photographs have a border unlike --background "
        f"{to_hex(background)}, in the median {to_hex(color / 255)}: give the color behind the "
        "part, or leave --background out"
    )


def _differs_from(border_pixels: UInt8[np.ndarray, "n 3"], color: Float[np.ndarray, "3"]) -> bool:
    """Most of `edge`: a part may reach over some of it."""
    return bool(
        (np.abs(border_pixels - color).max(axis=1) > MAX_BACKGROUND_DIFFERENCE).mean() > 0.5
    )


def to_hex(color: Float[np.ndarray, "3"]) -> str:
    """sRGB in [0, 1] as #rrggbb."""
    return "#" + "".join(f"{round(255 * float(value)):02x}" for value in color)


def _field_of_view_warning(views: Sequence[View]) -> str | None:
    angles = [
        angle for view in views if not MIN_FOV_DEG <= (angle := field_of_view(view)) <= MAX_FOV_DEG
    ]
    if not angles:
        return None
    return (
        f"{len(angles)} of {len(views)} photographs have a field of view above {MAX_FOV_DEG:g} or below "
        f"{MIN_FOV_DEG:g} degrees, the first of {angles[0]:.3g}: are fl_x and fl_y in px, not in mm, of "
        "an image of w x h px?"
    )


def field_of_view(view: View) -> float:
    """Degrees along the edge along which it is larger, as if the principal point were amid it."""
    height, width = view.rgb.shape[:2]
    tan_half_fov = max(width / 2 / view.K[0, 0], height / 2 / view.K[1, 1])
    return float(np.degrees(2 * np.arctan(tan_half_fov)))


def _dark_image_warning(views: Sequence[View]) -> str | None:
    dark = [max_value for view in views if (max_value := int(view.rgb.max())) < BLACK_THRESHOLD]
    if not dark:
        return None
    return (
        f"{len(dark)} of {len(views)} photographs are all but black, with no value above "
        f"{max(dark)} of 255; so look 12-bit values in 16-bit files: multiply those by 16"
    )
