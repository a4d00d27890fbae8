"""Figures of section 3.1: the source views, the grid X, the features E(I), and the field N(...)."""

from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Float32
from torch import Tensor

from industnerf.geometry.cameras import project
from industnerf.methods.industnerf.point_levels import grid_mean, grid_spacing, initial_grid
from industnerf.methods.industnerf.pooling import STATISTICS
from industnerf.report.docs.method_figures.pipeline_trace import PipelineTrace
from industnerf.report.figures.figure_style import new_figure, show_image

COLUMNS = 8  # of the source views
THUMBNAIL_STEP = 4  # px of a photograph for one of its thumbnail
SHOWN_WAVES = 3  # of PosE that are shown
GRID_STRIDE = 4  # the grid is drawn so many times coarser than it is


def plot_views(trace: PipelineTrace) -> Any:
    """All source views, and where they were taken from."""
    fig = new_figure(9, 3.8)
    left, right = fig.subfigures(1, 2, width_ratios=(3, 2))
    show_image(
        left.subplots(),
        mosaic(trace.images.rgb[:, ::THUMBNAIL_STEP, ::THUMBNAIL_STEP]),
        "the source views I",
    )
    axis = right.add_subplot(projection="3d")
    cameras = trace.images.cameras
    directions = (cameras.centers - trace.images.center) / trace.images.radius
    axis.quiver(*directions.T, *cameras.c2w[:, :3, 2].T, length=1.2, linewidth=0.7, color="#4c6a92")
    axis.scatter(*directions[trace.view], color="#d1495b", s=40)
    points = trace.coarse.points[trace.coarse.sigma > 0][::20].numpy()
    axis.scatter(*points.T, s=0.3, color="#555555")
    axis.set_title("their poses P (red: the view of the other figures)", fontsize=8)
    axis.set_box_aspect((1, 1, 1), zoom=1.3)
    axis.view_init(azim=15, elev=20)
    axis.set_axis_off()
    return fig


def mosaic(images: np.ndarray) -> np.ndarray:
    """All of `images` in rows of COLUMNS; what is left of the last row is white."""
    rows = -(-len(images) // COLUMNS)
    padded = np.full((rows * COLUMNS, *images.shape[1:]), 255, np.uint8)
    padded[: len(images)] = images
    n, height, width, _ = padded.shape
    tiles = padded.reshape(rows, n // rows, height, width, 3).swapaxes(1, 2)
    return tiles.reshape(rows * height, COLUMNS * width, 3)


def plot_grid(trace: PipelineTrace) -> Any:
    """X = S(r), and the pixels that a slice of it is projected to."""
    fig = new_figure(9, 4.4)
    points = initial_grid(grid_spacing(trace.settings.grid_res, 0), torch.device("cpu"))
    axis = fig.add_subplot(1, 2, 1, projection="3d")
    coarse_grid = initial_grid(2 * GRID_STRIDE / trace.settings.grid_res, torch.device("cpu"))
    cut = coarse_grid[(coarse_grid[:, 0] < 0) | (coarse_grid[:, 1] > 0)].numpy()
    axis.scatter(*cut.T, s=5, c=cut[:, 2], cmap="viridis", alpha=1, linewidths=0)
    title = f"X = S({trace.settings.grid_res}): {len(points):,} points"
    axis.set_title(f"{title}; every {GRID_STRIDE}th is drawn, each way", fontsize=8)
    axis.set_box_aspect((1, 1, 1), zoom=1.1)
    axis.tick_params(labelsize=5)
    height = slice_height(trace)
    slice_points = points[(points[:, 2] - height).abs() < 1 / trace.settings.grid_res]
    cameras, view = trace.images.cameras, trace.view
    uv, depth = project(trace.to_mm(slice_points), cameras.K[view], cameras.c2w[view])
    axis = fig.add_subplot(1, 2, 2)
    show_image(axis, trace.images.rgb[view], f"its slice z = {height:.2f} in a view, by depth")
    axis.scatter(*uv.T, s=1.2, c=-depth, cmap="viridis", linewidths=0)
    axis.set(xlim=(0, cameras.width), ylim=(cameras.height, 0))
    return fig


def plot_features(trace: PipelineTrace) -> Any:
    """E(I) of one view, and the features of all views pooled at the points of X.

    None without E, and where this view is no source view (R10).
    """
    coarse, view = trace.coarse, trace.view
    if coarse.features is None:
        return None
    fig = new_figure(9, 3.2)
    left, middle, right = fig.subplots(1, 3)
    show_image(left, trace.images.rgb[view], "a source view I")
    c, height, width = coarse.features.shape
    rows = coarse.features.reshape(c, -1).T
    title = f"F = E(I): {c} channels of {width} x {height},\nas their three principal components"
    show_image(middle, principal_components(rows).reshape(height, width, 3).numpy(), title)
    pooled = coarse.inputs[:, -num_pooled_channels(trace) :]
    statistics = ", ".join(STATISTICS[trace.settings.readings.view_pooling])
    title = f"pooled over the views at z = {slice_height(trace):.2f}:\n{statistics}, likewise"
    show_image(right, grid_slice(trace, principal_components(pooled)), title, origin="lower")
    return fig


def num_pooled_channels(trace: PipelineTrace) -> int:
    """How many of the columns of N's inputs are features: the last ones."""
    encoding_channels = (
        3
        if trace.settings.readings.position_encoding == "identity"
        else trace.settings.network.encoding_channels
    )
    return trace.coarse.inputs.shape[1] - encoding_channels


def plot_field(trace: PipelineTrace) -> Any:
    """A slice through what goes into N and comes out of it."""
    coarse, network = trace.coarse, trace.settings.network
    panels: list[tuple[str, np.ndarray, str | None]] = []
    if coarse.inputs is not None:
        for j in range(min(SHOWN_WAVES, network.encoding_channels // 6)):
            if trace.settings.readings.position_encoding != "identity":
                wave = coarse.inputs[:, 2 * j : 2 * j + 1]
                panels.append(
                    (f"PosE, $p^x[{2 * j}]$", grid_slice(trace, wave)[..., 0], "coolwarm")
                )
    sigma = grid_slice(trace, coarse.sigma[:, None])[..., 0]
    panels.append((r"density $\sigma$", sigma, "magma"))
    occupied_rgb = grid_slice(trace, coarse.rgb * (coarse.sigma > 0)[:, None])
    panels.append((r"color, where $\sigma > 0$", occupied_rgb, None))
    fig = new_figure(9, 9 / len(panels) + 0.4)
    for axis, (title, pixels, color_map) in zip(fig.subplots(1, len(panels)), panels, strict=True):
        show_image(axis, pixels, title, origin="lower", cmap=color_map)
    return fig


def slice_height(trace: PipelineTrace) -> float:
    """The height z at which the grid holds most density that can be seen."""
    coarse, grid_res = trace.coarse, trace.settings.grid_res
    visible_density = grid_mean(coarse.points, coarse.sigma * coarse.visibility, grid_res)
    return float((visible_density.sum((0, 1)).argmax() + 0.5) * 2 / grid_res - 1)


def grid_slice(trace: PipelineTrace, values: Float32[Tensor, "m c"]) -> Float[np.ndarray, "y x c"]:
    """The points' values in the plane at `slice_height`; not a number where there is no point."""
    grid_res, points = trace.settings.grid_res, trace.coarse.points
    layer = int((slice_height(trace) + 1) / 2 * grid_res)
    occupied = grid_mean(points, torch.ones_like(points[:, 0]), grid_res)[:, :, layer] > 0
    planes = [grid_mean(points, column, grid_res)[:, :, layer] for column in values.T]
    planes = torch.stack([plane.where(occupied, torch.nan) for plane in planes], dim=-1)
    return planes.transpose(0, 1).numpy()


def principal_components(rows: Float32[Tensor, "n c"]) -> Float32[Tensor, "n 3"]:
    """The three principal components of the rows as colors in [0, 1], all but 2 % unclipped."""
    columns = (rows - rows.mean(0)) / rows.std(0).clamp(min=1e-6)
    _, axes = torch.linalg.eigh(columns.T @ columns)
    basis = axes[:, -3:].flip(1)
    basis = basis * basis.sum(0).sign()  # eigenvectors have no sign of their own
    projected = columns @ basis
    low, high = projected.quantile(0.01, dim=0), projected.quantile(0.99, dim=0)
    return ((projected - low) / (high - low)).clamp(0, 1)
