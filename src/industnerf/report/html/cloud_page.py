"""A page of its own for any clouds: the report's viewer, and what a template says beside it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, UInt8
from scipy.spatial import cKDTree

from industnerf.report.html.page import CONTENT_SECURITY_POLICY, SCRIPTS, environment
from industnerf.report.html.viewer import (
    COLOR_MAPS,
    DISC_SPACINGS,
    SPAN,
    STEPS,
    Box,
    color_maps_base64,
    to_base64,
    z_order,
)
from industnerf.splats import core_box

SHOWN_POINTS = 65536  # of each cloud; of more, as many by chance
ALL_COLOR_MAPS = COLOR_MAPS | {"deviation": "coolwarm"}
LABELS = {
    "deviation": "deviation",
    "own": "its own color",
    "error": "distance",
    "confidence": "confidence",
    "height": "height",
}


@dataclass(frozen=True)
class ShownCloud:
    """A cloud of the page; what it has beside its points can color it."""

    name: str
    points: Float[np.ndarray, "n 3"]  # in the unit of the page
    caption: str
    colors: UInt8[np.ndarray, "n 3"] | None = None
    confidence: Float[np.ndarray, "n"] | None = None  # in [0, 1]
    error: Float[np.ndarray, "n"] | None = None  # a distance
    deviation: Float[np.ndarray, "n"] | None = None  # a signed one


@dataclass(frozen=True)
class ColorScale:
    """The ends that the scale of distances and deviations can have, in the unit of the page."""

    ends: Sequence[float]
    start: float  # one of `ends`
    tolerance: float | None = None  # marked on the scale of deviations


def render_cloud_page(
    template: str,
    title: str,
    clouds: Sequence[ShownCloud],
    unit: str,
    scale: ColorScale,
    note: str,
    **context: Any,
) -> str:
    """The text of a page that shows `clouds`; `note` explains what their colors mean."""
    colorings = {name: text for name, text in LABELS.items() if _has(clouds, name)}
    scene = _scene(clouds, unit, max(scale.ends)) | {"tolerance_mm": scale.tolerance}
    viewer = {
        "names": [cloud.name for cloud in clouds],
        "colorings": colorings,
        "limits": [end / scene["diagonal_mm"] for end in scale.ends],
        "default_limit": scale.start / scene["diagonal_mm"],
        "note": note,
        "is_single": True,
        "color_maps": color_maps_base64(ALL_COLOR_MAPS),
        "scenes": [{"part_id": "clouds", "designation": title, "data": scene}],
    }
    return (
        environment()
        .get_template(template)
        .render(
            title=title,
            viewer=viewer,
            scripts=SCRIPTS,
            content_security_policy=CONTENT_SECURITY_POLICY,
            **context,
        )
    )


def _has(clouds: Sequence[ShownCloud], coloring: str) -> bool:
    attribute = {"own": "colors", "height": "points"}.get(coloring, coloring)
    return any(getattr(cloud, attribute) is not None for cloud in clouds)


def _scene(clouds: Sequence[ShownCloud], unit: str, max_error: float) -> dict[str, Any]:
    """What viewer.js decodes; its lengths are in `unit`, also where their names end in mm."""
    low, high = core_box(np.concatenate([cloud.points for cloud in clouds]))
    diagonal = float(np.linalg.norm(high - low)) or 1.0
    box = Box((low + high) / 2, diagonal)
    spacing = max(_spacing(cloud.points) for cloud in clouds)
    return {
        "unit": unit,
        "diagonal_mm": diagonal,
        "span": SPAN,
        "max_error_mm": max_error,
        "disc_diameter": DISC_SPACINGS * spacing / diagonal,
        "packed": {cloud.name: _pack(cloud, box, max_error) for cloud in clouds},
    }


def _spacing(points: Float[np.ndarray, "n 3"]) -> float:
    """The mean distance to the fourth nearest of the points that are shown.

    On a square lattice that is its step, and of points at random what a lattice as dense has.
    """
    shown = points[_shown(len(points))]
    if len(shown) < 5:
        return 1.0
    return float(cKDTree(shown).query(shown, 5)[0][:, 4].mean()) or 1.0


def _shown(count: int) -> np.ndarray:
    """The indices of the points to show: all, or a choice that is the same each time."""
    if count <= SHOWN_POINTS:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, SHOWN_POINTS, replace=False))


def _pack(cloud: ShownCloud, box: Box, max_error: float) -> dict[str, Any]:
    indices = _shown(len(cloud.points))
    quantized = np.rint(box.quantize_positions(cloud.points[indices].astype(np.float64)))
    inside = np.flatnonzero(((quantized >= 0) & (quantized <= STEPS)).all(axis=1))
    inside = inside[z_order(quantized[inside])]
    arrays = {"positions": quantized[inside].astype(np.uint16)}
    shown = indices[inside]
    if cloud.colors is not None:
        arrays["color"] = cloud.colors[shown]
    if cloud.confidence is not None:
        arrays["confidence"] = np.rint(255 * np.clip(cloud.confidence[shown], 0, 1)).astype("u1")
    if cloud.error is not None:
        roots = np.sqrt(np.clip(cloud.error[shown] / max_error, 0, 1))
        arrays["error"] = np.rint(255 * roots).astype(np.uint8)
    if cloud.deviation is not None:
        share = np.clip(cloud.deviation[shown] / max_error, -1, 1)
        arrays["deviation"] = np.rint(32767.5 * (share + 1)).astype(np.uint16)
    caption = f"{cloud.caption}; {len(shown)} of {len(cloud.points)} points are shown"
    return {"count": len(shown), "caption": caption, "arrays": to_base64(arrays)}
