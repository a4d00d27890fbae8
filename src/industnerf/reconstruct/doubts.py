"""What can be right and seldom is: a sentence each, as a cloud would come out all the same."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, UInt8

from industnerf.geometry.silhouettes import border
from industnerf.reconstruct.views import View

UNLIKE = 255 / 8  # in a channel: more than light that falls off, or compression
DARK = 255 / 8  # 12 bits of 16 end at 255 / 16
WIDE, NARROW = 120.0, 1.0  # degrees; beyond, a pinhole camera is a slip


def doubts(views: Sequence[View], background: Float[np.ndarray, "3"] | None) -> list[str]:
    """Sentences on `views`; `background` (sRGB in [0, 1]) is what the user said of it, if any."""
    said = [_other_background(views, background), _odd_lens(views), _all_but_black(views)]
    return [sentence for sentence in said if sentence]


def _other_background(
    views: Sequence[View], background: Float[np.ndarray, "3"] | None
) -> str | None:
    """Where a photograph is see-through it shows `background`, so is not unlike it."""
    if background is None:
        return None
    borders = [border(view.rgb) for view in views]
    unlike = [edge for edge in borders if _differs(edge, 255 * background)]
    if not unlike:
        return None
    colour = np.median(np.concatenate(unlike), axis=0)
    return (
        f"{len(unlike)} of {len(views)} photographs have a border unlike --background "
        f"{hexed(background)}, in the median {hexed(colour / 255)}: give the colour behind the "
        "part, or leave --background out"
    )


def _differs(edge: UInt8[np.ndarray, "n 3"], colour: Float[np.ndarray, "3"]) -> bool:
    """Most of `edge`: a part may reach over some of it."""
    return bool((np.abs(edge - colour).max(axis=1) > UNLIKE).mean() > 0.5)


def hexed(colour: Float[np.ndarray, "3"]) -> str:
    """sRGB in [0, 1] as #rrggbb."""
    return "#" + "".join(f"{round(255 * float(value)):02x}" for value in colour)


def _odd_lens(views: Sequence[View]) -> str | None:
    angles = [angle for view in views if not NARROW <= (angle := field_of_view(view)) <= WIDE]
    if not angles:
        return None
    return (
        f"{len(angles)} of {len(views)} photographs have a field of view above {WIDE:g} or below "
        f"{NARROW:g} degrees, the first of {angles[0]:.3g}: are fl_x and fl_y in px, not in mm, of "
        "an image of w x h px?"
    )


def field_of_view(view: View) -> float:
    """Degrees along the edge along which it is larger, as if the principal point were amid it."""
    height, width = view.rgb.shape[:2]
    slope = max(width / 2 / view.K[0, 0], height / 2 / view.K[1, 1])
    return float(np.degrees(2 * np.arctan(slope)))


def _all_but_black(views: Sequence[View]) -> str | None:
    dark = [top for view in views if (top := int(view.rgb.max())) < DARK]
    if not dark:
        return None
    return (
        f"{len(dark)} of {len(views)} photographs are all but black, with no value above "
        f"{max(dark)} of 255; so look 12-bit values in 16-bit files: multiply those by 16"
    )
