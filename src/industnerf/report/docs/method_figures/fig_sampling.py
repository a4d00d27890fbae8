"""Figures of section 3.2: the density as a distribution, and the points that are drawn from it."""

from typing import Any

import numpy as np
from jaxtyping import Float32, Float64
from torch import Tensor

from industnerf.methods.industnerf.density_pdf import (
    marginal_x,
    marginal_xy,
    pdf,
    sampling_density,
    y_given_x,
    z_given_xy,
)
from industnerf.methods.industnerf.point_levels import grid_mean
from industnerf.report.docs.method_figures.pipeline_trace import PipelineTrace
from industnerf.report.figures.figure_style import add_colorbar, colorize, new_figure, show_image
from industnerf.splats import splat

SIZE = 300  # px of a cloud
DISPLAY_POWER = 0.5  # shares are shown as their roots: few cells hold most of the density


def plot_density_pdf(trace: PipelineTrace) -> Any:
    """Eqs. (5)-(9) of the first level's grid."""
    coarse, grid_res = trace.coarse, trace.settings.grid_res
    sigma, visibility = (
        grid_mean(coarse.points, x, grid_res) for x in (coarse.sigma, coarse.visibility)
    )
    p = pdf(sampling_density(sigma, visibility, trace.settings.readings.sampling_density))
    fig = new_figure(9, 5.6)
    (xy, xz, yz), (x, y, z) = fig.subplots(2, 3)
    _show_plane(xy, marginal_xy(p), "(6)  PDF(x, y)", "x", "y")
    _show_plane(xz, p.sum(1), "the same over y", "x", "z")
    _show_plane(yz, p.sum(0), "the same over x", "y", "z")
    x.bar(np.arange(grid_res), marginal_x(p).numpy(), width=1.0, color="#4c6a92")
    x.set_title("(7)  PDF(x) and its sum", fontsize=8)
    cumulative_axis = x.twinx()
    cumulative_axis.step(
        np.arange(grid_res) + 0.5, marginal_x(p).cumsum(0).numpy(), color="#d1495b", linewidth=1
    )
    cumulative_axis.set_ylim(0, 1.02)
    for axis in (x, cumulative_axis):
        axis.tick_params(labelsize=6)
    x.set_xlabel("x, cells", fontsize=7)
    _show_plane(y, y_given_x(p), "(8)  PDF(y | x)", "x", "y")
    densest_y = int(marginal_xy(p).sum(0).argmax())
    _show_plane(z, z_given_xy(p)[:, densest_y], f"(9)  PDF(z | x, y), y = {densest_y}", "x", "z")
    return fig


def _show_plane(
    axis: Any, shares: Float64[Tensor, "r u"], title: str, x_label: str, y_label: str
) -> None:
    """A table of shares, seen as cells of the grid."""
    show_image(axis, (shares.numpy() ** DISPLAY_POWER).T, title, origin="lower", cmap="magma")
    axis.set_xlabel(f"{x_label} →", fontsize=7)
    axis.set_ylabel(f"{y_label} →", fontsize=7)


def plot_refined_points(trace: PipelineTrace) -> Any:
    """The first level's cloud points, the drawn ones, and what the last level makes of both."""
    if not len(trace.sampled_points):
        return None
    coarse, fine = trace.coarse, trace.fine
    is_coarse_occupied, is_fine_occupied = coarse.sigma > 0, fine.sigma > 0
    fig = new_figure(9, 3.3)
    axes = fig.subplots(1, 3)
    max_sigma = float(fine.sigma.quantile(0.99))
    panels = (
        (
            coarse.points[is_coarse_occupied],
            coarse.sigma[is_coarse_occupied],
            "the grid's points with $\\sigma > 0$",
        ),
        (trace.sampled_points, None, "drawn from its distribution"),
        (
            fine.points[is_fine_occupied],
            fine.sigma[is_fine_occupied],
            "the last level's points with $\\sigma > 0$",
        ),
    )
    for axis, (points, sigma, title) in zip(axes, panels, strict=True):
        shade = np.full(len(points), 0.45) if sigma is None else sigma.numpy() / max_sigma
        show_image(axis, _splat_view(trace, points, shade), f"{len(points):,} points:\n{title}")
    add_colorbar(fig, axes[2], "viridis", max_sigma, r"density $\sigma$, 1 / radius of the region")
    return fig


def _splat_view(
    trace: PipelineTrace, points: Float32[Tensor, "m 3"], shade: np.ndarray
) -> np.ndarray:
    colors = colorize(shade, "viridis", 1.0)
    return splat(trace.to_mm(points), colors, trace.images.cameras, trace.view, SIZE)
