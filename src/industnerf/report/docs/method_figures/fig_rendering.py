"""Figures of section 3.3: one ray through the cloud, and a re-rendered view."""

from typing import Any

import numpy as np
import torch

from industnerf.rendering.confidence import color_confidence, color_scale
from industnerf.report.docs.method_figures.pipeline_trace import PipelineTrace
from industnerf.report.docs.method_figures.ray_profile import (
    RayProfile,
    distance_to_line,
    trace_ray,
)
from industnerf.report.figures.figure_style import add_colorbar, new_figure, show_image

OPAQUE = 0.9  # opacity of the pixel that is chosen for its ray
SLAB_SPACINGS = 8.0  # spacings of cloud that are shown on either side of the ray
MAX_ERROR = 0.3  # |I - O| at the end of the color scale


def plot_ray(trace: PipelineTrace) -> Any:
    """The radiance points of one ray: their density, T of eq. (10), and what each adds."""
    row, column = central_opaque_pixel(trace)
    ray_profile = trace_ray(trace, row, column)
    fig = new_figure(9, 4.6)
    left, right = fig.subfigures(1, 2, width_ratios=(1, 2))
    axis = left.subplots()
    show_image(axis, trace.images.rgb[trace.view], "the ray's pixel")
    axis.scatter([column + 0.5], [row + 0.5], s=50, facecolors="none", edgecolors="#d1495b")
    top, bottom = right.subplots(2, 1, sharex=True)
    _plot_cross_section(top, trace, ray_profile)
    _plot_along_ray(bottom, trace, ray_profile)
    return fig


def central_opaque_pixel(trace: PipelineTrace) -> tuple[int, int]:
    """Row and column of the opaque pixel nearest to the middle of the opaque ones."""
    opaque = np.argwhere(trace.rendered.opacity[0] >= OPAQUE * 255)
    if not len(opaque):
        return trace.images.cameras.height // 2, trace.images.cameras.width // 2
    middle = opaque.mean(axis=0)
    row, column = opaque[np.argmin(((opaque - middle) ** 2).sum(axis=1))]
    return int(row), int(column)


def _plot_cross_section(axis: Any, trace: PipelineTrace, ray_profile: RayProfile) -> None:
    """The cloud in a thin slab that holds the ray."""
    fine = trace.fine
    offsets = fine.points - ray_profile.origin
    up = torch.linalg.cross(ray_profile.direction, offsets.new_tensor([0.0, 0.0, 1.0]))
    across = torch.linalg.cross(ray_profile.direction, up / up.norm())
    t, side = offsets @ ray_profile.direction, offsets @ across
    near = (
        distance_to_line(fine.points, ray_profile.origin, ray_profile.direction)
        < SLAB_SPACINGS * fine.spacing
    )
    in_slab = ((offsets @ (up / up.norm())).abs() < fine.spacing) & near & (fine.sigma > 0)
    side_spacings = side[in_slab].numpy() / fine.spacing
    axis.scatter(t[in_slab].numpy(), side_spacings, s=4, c=fine.rgb[in_slab].numpy())
    axis.axhline(0, color="#4c6a92", linewidth=0.6)
    sizes = 4 + 150 * ray_profile.weights.numpy()
    axis.scatter(ray_profile.t.numpy(), 0 * sizes, s=sizes, color="#d1495b", zorder=3)
    axis.set_ylabel("cloud points beside\nthe ray, spacings", fontsize=7)
    axis.tick_params(labelsize=6)
    axis.set_title("radiance points (red, area: weight) among the cloud points", fontsize=8)


def _plot_along_ray(axis: Any, trace: PipelineTrace, ray_profile: RayProfile) -> None:
    """sigma, T and T alpha of the samples."""
    width = trace.settings.fine_step_size * trace.fine.spacing
    t, transmittance, weights, sigma = (
        x.numpy()
        for x in (ray_profile.t, ray_profile.transmittance, ray_profile.weights, ray_profile.sigma)
    )
    colors = ray_profile.rgb.clamp(0, 1).numpy()  # means of colors, which round
    axis.bar(t, weights, width, color=colors, edgecolor="#333333")
    axis.step(t - width / 2, transmittance, where="post", color="#d1495b", label="T (10)")
    axis.plot([], [], "s", color="#aaaaaa", label=r"T $\alpha$, in the sample's color")
    axis.set_ylim(0, 1.05)
    axis.set_xlabel("t along the ray, radii of the region", fontsize=7)
    density_axis = axis.twinx()
    density_axis.plot(t, sigma, ".-", markersize=2, linewidth=0.7, color="#4c6a92")
    density_axis.set_ylabel(r"density $\sigma$", color="#4c6a92", fontsize=7)
    axis.legend(fontsize=6, loc="center right")
    for each_axis in (axis, density_axis):
        each_axis.tick_params(labelsize=6)


def plot_rerendering(trace: PipelineTrace) -> Any:
    """A source view beside its re-rendering: what training lowers, and S of eq. (12)."""
    images = trace.images.rgb[trace.view], trace.rendered.rgb[0]
    source, rerendering = (torch.from_numpy(pixels.reshape(-1, 3) / 255.0) for pixels in images)
    shape = images[0].shape[:2]
    error = (source - rerendering).norm(dim=1).reshape(shape).numpy()
    contrast = float((source.amax(0) - source.amin(0)).norm())
    scale = color_scale(trace.settings.readings.color_scale, contrast)
    color_agreement = color_confidence(source, rerendering, scale).reshape(shape).numpy()
    fig = new_figure(9, 2.9)
    axes = fig.subplots(1, 4)
    show_image(axes[0], images[0], "source view I")
    show_image(axes[1], images[1], "rendered anew, O")
    show_image(axes[2], error, "|I - O|", cmap="magma", vmin=0, vmax=MAX_ERROR)
    show_image(
        axes[3], color_agreement, f"(12)  S, with L = {scale:.2f}", cmap="viridis", vmin=0, vmax=1
    )
    add_colorbar(fig, axes[2], "magma", MAX_ERROR, "")
    add_colorbar(fig, axes[3], "viridis", 1.0, "")
    return fig
