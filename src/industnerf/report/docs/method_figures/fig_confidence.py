"""Figures of section 3.4: the confidence of each view, and the final cloud."""

from typing import Any

import numpy as np

from industnerf.report.docs.method_figures.pipeline_trace import PipelineTrace
from industnerf.report.figures.figure_style import add_colorbar, colorize, new_figure, show_image
from industnerf.splats import splat

SIZE = 300  # px of a cloud


def plot_confidence(trace: PipelineTrace) -> Any:
    """Eq. (13) of three views, and its maximum over all views."""
    fine, occupied = trace.fine, trace.fine.sigma > 0
    points, max_confidence = trace.to_mm(fine.points[occupied]), float(fine.confidence.max())
    fig = new_figure(9, 5.2)
    columns = len(fine.view_confidences) + 1
    axes = fig.subplots(2, columns)
    cloud_colors = (255 * fine.rgb[occupied]).byte().numpy()
    panels = [
        (f"view {v}", trace.images.rgb[v][::2, ::2], "as it has them", view_confidence)
        for v, view_confidence in fine.view_confidences.items()
    ]
    all_views_title = f"maximum over all {len(trace.images.rgb)} views"
    panels.append(
        (
            "the cloud points",
            _splat_view(trace, points, cloud_colors),
            all_views_title,
            fine.confidence,
        )
    )
    for (above, below), (title, pixels, subtitle, values) in zip(axes.T, panels, strict=True):
        show_image(above, pixels, title)
        colors = colorize(values[occupied].numpy(), "viridis", max_confidence)
        show_image(below, _splat_view(trace, points, colors), subtitle)
    add_colorbar(fig, axes[1, -1], "viridis", max_confidence, "confidence (13)")
    return fig


def _splat_view(trace: PipelineTrace, points: np.ndarray, colors: np.ndarray) -> np.ndarray:
    """Points (mm) from the chosen view; a blank picture if there are none."""
    if not len(points):
        return np.full((SIZE, SIZE, 3), 255, np.uint8)
    return splat(points.astype(float), colors, trace.images.cameras, trace.view, SIZE)


def plot_cloud(trace: PipelineTrace) -> Any:
    """The final cloud by color, by confidence, and by the view with the highest confidence."""
    max_confidence = float(trace.confidence.max(initial=1e-6))
    fig = new_figure(9, 2.8)
    axes = fig.subplots(1, 4)
    confidence_colors = colorize(trace.confidence, "viridis", max_confidence)
    directions = trace.images.cameras.centers - trace.images.center
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    view_colors = (255 * (0.5 + 0.5 * directions[trace.argmax_view])).astype(np.uint8)
    view_colors[trace.argmax_view < 0] = 160  # no pixel looks at these
    show_image(axes[0], trace.images.rgb[trace.view], "source view")
    panels = (
        (trace.colors, f"{len(trace.cloud_mm):,} points: color"),
        (confidence_colors, "confidence"),
        (view_colors, "surest view,\nx y z of its direction as r g b"),
    )
    for axis, (colors, title) in zip(axes[1:], panels, strict=True):
        show_image(axis, _splat_view(trace, trace.cloud_mm, colors), title)
    add_colorbar(fig, axes[2], "viridis", max_confidence, "")
    return fig
