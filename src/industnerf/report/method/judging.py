"""Plates of section 3.4: how sure each view is of each point, and the final cloud."""

from typing import Any

import numpy as np

from industnerf.report.method.making import Making
from industnerf.report.plates import figure, legend, picture, tinted
from industnerf.splats import splat

SIZE = 300  # px of a cloud


def confidence(making: Making) -> Any:
    """Eq. (13) as three views have it, and its maximum over all views."""
    fine, dense = making.fine, making.fine.sigma > 0
    points, top = making.in_mm(fine.points[dense]), float(fine.confidence.max())
    drawn = figure(9, 5.2)
    columns = len(fine.witnesses) + 1
    axes = drawn.subplots(2, columns)
    own = (255 * fine.rgb[dense]).byte().numpy()
    told = [
        (f"view {v}", making.posed.rgb[v][::2, ::2], "as it has them", some)
        for v, some in fine.witnesses.items()
    ]
    all_of_them = f"maximum over all {len(making.posed.rgb)} views"
    told.append(("the cloud points", _seen(making, points, own), all_of_them, fine.confidence))
    for (above, below), (who, pixels, what, values) in zip(axes.T, told, strict=True):
        picture(above, pixels, who)
        colours = tinted(values[dense].numpy(), "viridis", top)
        picture(below, _seen(making, points, colours), what)
    legend(drawn, axes[1, -1], "viridis", top, "confidence (13)")
    return drawn


def _seen(making: Making, points: np.ndarray, colours: np.ndarray) -> np.ndarray:
    """Points (mm) from the chosen view; a blank picture if there are none."""
    if not len(points):
        return np.full((SIZE, SIZE, 3), 255, np.uint8)
    return splat(points.astype(float), colours, making.posed.cameras, making.view, SIZE)


def cloud(making: Making) -> Any:
    """The final cloud by colour, by confidence, and by the view that is surest."""
    top = float(making.confidence.max(initial=1e-6))
    drawn = figure(9, 2.8)
    axes = drawn.subplots(1, 4)
    sure = tinted(making.confidence, "viridis", top)
    away = making.posed.cameras.eyes - making.posed.centre
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    view = (255 * (0.5 + 0.5 * away[making.sure])).astype(np.uint8)
    view[making.sure < 0] = 160  # no pixel looks at these
    picture(axes[0], making.posed.rgb[making.view], "source view")
    kinds = (
        (making.colours, f"{len(making.cloud_mm):,} points: colour"),
        (sure, "confidence"),
        (view, "surest view,\nx y z of its direction as r g b"),
    )
    for axis, (colours, what) in zip(axes[1:], kinds, strict=True):
        picture(axis, _seen(making, making.cloud_mm, colours), what)
    legend(drawn, axes[2], "viridis", top, "")
    return drawn
