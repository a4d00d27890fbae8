"""Photographs of different sizes, brought to one: a window of each about the region of interest.

A window is cut and not scaled, so no pixel is blurred and a camera's principal point just moves.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from industnerf.geometry.cameras import Cameras, project
from industnerf.geometry.silhouettes import border
from industnerf.reconstruct.images import View

MARGIN = 1.05  # of the window, over what the region of interest takes


def have_one_size(views: Sequence[View]) -> bool:
    """Whether all views have as many rows and columns."""
    return len({view.size for view in views}) == 1


def framing_cameras(views: Sequence[View]) -> Cameras:
    """The cameras of whole photographs: in px, or in shares of the image if sizes differ."""
    c2w = np.stack([view.camera.c2w for view in views])
    K = np.stack([view.K for view in views])
    if have_one_size(views):
        return Cameras(K, c2w, *views[0].size)
    to_share = np.stack([np.diag([1 / view.size[0], 1 / view.size[1], 1.0]) for view in views])
    return Cameras(to_share @ K, c2w, 1, 1)


def crop_to_region(
    views: Sequence[View],
    center: Float[np.ndarray, "3"],
    radius: float,
    background: Float[np.ndarray, "3"] | None,
) -> list[View]:
    """Windows of one size that hold the region of interest, as far as its photograph does.

    What lies beyond a photograph shows `background` (sRGB in [0, 1]), or the median of its border.
    """
    boxes = [_region_box(view, center, radius) for view in views]
    most = np.max([view.size for view in views], axis=0)
    width, height = np.minimum(np.ceil(np.max([size for _, size in boxes], axis=0)), most)
    return [
        _window(view, middle, int(width), int(height), background)
        for view, (middle, _) in zip(views, boxes, strict=True)
    ]


def _region_box(
    view: View, center: Float[np.ndarray, "3"], radius: float
) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]]:
    """The middle and the size, both in px, of what the ball takes in the image."""
    c2w = view.camera.c2w
    distance = float(np.linalg.norm(center - c2w[:3, 3]))
    focal = view.K[[0, 1], [0, 1]]
    # the outline of a ball is at asin(r / d) from its center
    tangent = radius / np.sqrt(max(distance**2 - radius**2, 1e-12 * distance**2))
    middle = project(center[None], view.K, c2w)[0][0]
    return middle, 2 * MARGIN * tangent * focal


def _window(
    view: View,
    middle: Float[np.ndarray, "2"],
    width: int,
    height: int,
    background: Float[np.ndarray, "3"] | None,
) -> View:
    """`width` x `height` px about `middle`, moved into the photograph as far as it fits."""
    fill = np.median(border(view.rgb), axis=0) if background is None else 255 * background
    pixels = np.empty((height, width, 3), np.uint8)
    pixels[:] = np.rint(fill)
    left, target_x, source_x = _overlap(view.size[0], width, middle[0])
    top, target_y, source_y = _overlap(view.size[1], height, middle[1])
    pixels[target_y, target_x] = view.rgb[source_y, source_x]
    K = view.K.copy()
    K[:2, 2] -= [left, top]
    return replace(view, pixels=pixels, K=K)


def _overlap(available: int, wanted: int, middle: float) -> tuple[int, slice, slice]:
    """Where the window begins, and the part of it, and of the image, that both have."""
    if wanted <= available:
        start = int(np.clip(round(middle - wanted / 2), 0, available - wanted))
        return start, slice(0, wanted), slice(start, start + wanted)
    start = -((wanted - available) // 2)
    return start, slice(-start, available - start), slice(0, available)
