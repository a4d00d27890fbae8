"""Plates of section 3.1: the source views, the grid X, the features E(I), and the field N(...)."""

from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Float32
from torch import Tensor

from industnerf.geometry.cameras import project
from industnerf.methods.industnerf.levels import grid, on_grid, spacing_of
from industnerf.methods.industnerf.pooling import STATISTICS
from industnerf.report.method.making import Making
from industnerf.report.plates import figure, picture

COLUMNS = 8  # of the source views
THUMB = 4  # px of a photograph for one of its thumbnail
WAVES = 3  # of PosE that are shown
COARSER = 4  # the grid is drawn so many times coarser than it is


def views(making: Making) -> Any:
    """All source views, and where they were taken from."""
    drawn = figure(9, 3.8)
    left, right = drawn.subfigures(1, 2, width_ratios=(3, 2))
    picture(left.subplots(), mosaic(making.posed.rgb[:, ::THUMB, ::THUMB]), "the source views I")
    axis = right.add_subplot(projection="3d")
    cameras = making.posed.cameras
    away = (cameras.eyes - making.posed.centre) / making.posed.radius
    axis.quiver(*away.T, *cameras.c2w[:, :3, 2].T, length=1.2, linewidth=0.7, color="#4c6a92")
    axis.scatter(*away[making.view], color="#d1495b", s=40)
    points = making.coarse.points[making.coarse.sigma > 0][::20].numpy()
    axis.scatter(*points.T, s=0.3, color="#555555")
    axis.set_title("their poses P (red: the view of the other plates)", fontsize=8)
    axis.set_box_aspect((1, 1, 1), zoom=1.3)
    axis.view_init(azim=15, elev=20)
    axis.set_axis_off()
    return drawn


def mosaic(images: np.ndarray) -> np.ndarray:
    """All of `images` in rows of COLUMNS; what is left of the last row is white."""
    rows = -(-len(images) // COLUMNS)
    filled = np.full((rows * COLUMNS, *images.shape[1:]), 255, np.uint8)
    filled[: len(images)] = images
    n, height, width, _ = filled.shape
    table = filled.reshape(rows, n // rows, height, width, 3).swapaxes(1, 2)
    return table.reshape(rows * height, COLUMNS * width, 3)


def cubes(making: Making) -> Any:
    """X = S(r), and the pixels that a slice of it is projected to."""
    drawn = figure(9, 4.4)
    points = grid(spacing_of(making.settings.grid_res, 0), torch.device("cpu"))
    axis = drawn.add_subplot(1, 2, 1, projection="3d")
    some = grid(2 * COARSER / making.settings.grid_res, torch.device("cpu"))
    cut = some[(some[:, 0] < 0) | (some[:, 1] > 0)].numpy()
    axis.scatter(*cut.T, s=5, c=cut[:, 2], cmap="viridis", alpha=1, linewidths=0)
    title = f"X = S({making.settings.grid_res}): {len(points):,} points"
    axis.set_title(f"{title}; every {COARSER}th is drawn, each way", fontsize=8)
    axis.set_box_aspect((1, 1, 1), zoom=1.1)
    axis.tick_params(labelsize=5)
    place = slab(making)
    flat = points[(points[:, 2] - place).abs() < 1 / making.settings.grid_res]
    cameras, view = making.posed.cameras, making.view
    uv, depth = project(making.in_mm(flat), cameras.K[view], cameras.c2w[view])
    axis = drawn.add_subplot(1, 2, 2)
    picture(axis, making.posed.rgb[view], f"its slice z = {place:.2f} in a view, by depth")
    axis.scatter(*uv.T, s=1.2, c=-depth, cmap="viridis", linewidths=0)
    axis.set(xlim=(0, cameras.width), ylim=(cameras.height, 0))
    return drawn


def features(making: Making) -> Any:
    """E(I) of one view, and the features of all views pooled at the points of X.

    None without E, and where N is not told of this view (R10).
    """
    coarse, view = making.coarse, making.view
    if coarse.features is None:
        return None
    drawn = figure(9, 3.2)
    one, two, three = drawn.subplots(1, 3)
    picture(one, making.posed.rgb[view], "a source view I")
    c, height, width = coarse.features.shape
    rows = coarse.features.reshape(c, -1).T
    title = f"F = E(I): {c} channels of {width} x {height},\nas their three principal components"
    picture(two, components(rows).reshape(height, width, 3).numpy(), title)
    pooled = coarse.inputs[:, -channels_pooled(making) :]
    kinds = ", ".join(STATISTICS[making.settings.readings.views])
    title = f"pooled over the views at z = {slab(making):.2f}:\n{kinds}, likewise"
    picture(three, slice_of(making, components(pooled)), title, origin="lower")
    return drawn


def channels_pooled(making: Making) -> int:
    """How many of the columns of N's inputs are features: the last ones."""
    posed = 3 if making.settings.readings.pose == "identity" else making.settings.network.channels
    return making.coarse.inputs.shape[1] - posed


def field(making: Making) -> Any:
    """A slice through what goes into N and comes out of it."""
    coarse, ways = making.coarse, making.settings.network
    shown: list[tuple[str, np.ndarray, str | None]] = []
    if coarse.inputs is not None:
        for j in range(min(WAVES, ways.channels // 6)):
            if making.settings.readings.pose != "identity":
                wave = coarse.inputs[:, 2 * j : 2 * j + 1]
                shown.append((f"PosE, $p^x[{2 * j}]$", slice_of(making, wave)[..., 0], "coolwarm"))
    sigma = slice_of(making, coarse.sigma[:, None])[..., 0]
    shown.append((r"density $\sigma$", sigma, "magma"))
    solid = slice_of(making, coarse.rgb * (coarse.sigma > 0)[:, None])
    shown.append((r"colour, where $\sigma > 0$", solid, None))
    drawn = figure(9, 9 / len(shown) + 0.4)
    for axis, (title, pixels, colours) in zip(drawn.subplots(1, len(shown)), shown, strict=True):
        picture(axis, pixels, title, origin="lower", cmap=colours)
    return drawn


def slab(making: Making) -> float:
    """The height z at which the grid holds most density that can be seen."""
    coarse, cells = making.coarse, making.settings.grid_res
    seen = on_grid(coarse.points, coarse.sigma * coarse.visibility, cells)
    return float((seen.sum((0, 1)).argmax() + 0.5) * 2 / cells - 1)


def slice_of(making: Making, values: Float32[Tensor, "m c"]) -> Float[np.ndarray, "y x c"]:
    """The points' values in the plane at `slab`; not a number where there is no point."""
    cells, points = making.settings.grid_res, making.coarse.points
    layer = int((slab(making) + 1) / 2 * cells)
    there = on_grid(points, torch.ones_like(points[:, 0]), cells)[:, :, layer] > 0
    planes = [on_grid(points, column, cells)[:, :, layer] for column in values.T]
    planes = torch.stack([plane.where(there, torch.nan) for plane in planes], dim=-1)
    return planes.transpose(0, 1).numpy()


def components(rows: Float32[Tensor, "n c"]) -> Float32[Tensor, "n 3"]:
    """The three principal components of the rows as colours in [0, 1], all but 2 % unclipped."""
    columns = (rows - rows.mean(0)) / rows.std(0).clamp(min=1e-6)
    _, axes = torch.linalg.eigh(columns.T @ columns)
    main = axes[:, -3:].flip(1)
    main = main * main.sum(0).sign()  # eigenvectors have no sign of their own
    shades = columns @ main
    low, high = shades.quantile(0.01, dim=0), shades.quantile(0.99, dim=0)
    return ((shades - low) / (high - low)).clamp(0, 1)
