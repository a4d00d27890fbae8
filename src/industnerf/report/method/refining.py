"""Plates of section 3.2: the density as a distribution, and the points that are drawn from it."""

from typing import Any

import numpy as np
from jaxtyping import Float32, Float64
from torch import Tensor

from industnerf.methods.industnerf.distribution import (
    density_to_sample,
    marginal_x,
    marginal_xy,
    pdf,
    y_given_x,
    z_given_xy,
)
from industnerf.methods.industnerf.levels import on_grid
from industnerf.report.method.making import Making
from industnerf.report.plates import figure, legend, picture, tinted
from industnerf.splats import splat

SIZE = 300  # px of a cloud
POWER = 0.5  # shares are shown as their roots: few cells hold most of the density


def distribution(making: Making) -> Any:
    """Eqs. (5)-(9) of the first level's grid."""
    coarse, cells = making.coarse, making.settings.grid_res
    sigma, seen = (on_grid(coarse.points, x, cells) for x in (coarse.sigma, coarse.visibility))
    p = pdf(density_to_sample(sigma, seen, making.settings.readings.target))
    drawn = figure(9, 5.6)
    (xy, xz, yz), (x, y, z) = drawn.subplots(2, 3)
    _plane(xy, marginal_xy(p), "(6)  PDF(x, y)", "x", "y")
    _plane(xz, p.sum(1), "the same over y", "x", "z")
    _plane(yz, p.sum(0), "the same over x", "y", "z")
    x.bar(np.arange(cells), marginal_x(p).numpy(), width=1.0, color="#4c6a92")
    x.set_title("(7)  PDF(x) and its sum", fontsize=8)
    other = x.twinx()
    other.step(
        np.arange(cells) + 0.5, marginal_x(p).cumsum(0).numpy(), color="#d1495b", linewidth=1
    )
    other.set_ylim(0, 1.02)
    for axis in (x, other):
        axis.tick_params(labelsize=6)
    x.set_xlabel("x, cells", fontsize=7)
    _plane(y, y_given_x(p), "(8)  PDF(y | x)", "x", "y")
    most = int(marginal_xy(p).sum(0).argmax())
    _plane(z, z_given_xy(p)[:, most], f"(9)  PDF(z | x, y), y = {most}", "x", "z")
    return drawn


def _plane(axis: Any, shares: Float64[Tensor, "r u"], title: str, right: str, up: str) -> None:
    """A table of shares, seen as cells of the grid."""
    picture(axis, (shares.numpy() ** POWER).T, title, origin="lower", cmap="magma")
    axis.set_xlabel(f"{right} →", fontsize=7)
    axis.set_ylabel(f"{up} →", fontsize=7)


def refined(making: Making) -> Any:
    """The first level's cloud points, the drawn ones, and what the last level makes of both."""
    if not len(making.drawn):
        return None
    coarse, fine = making.coarse, making.fine
    old, new = coarse.sigma > 0, fine.sigma > 0
    drawn = figure(9, 3.3)
    axes = drawn.subplots(1, 3)
    top = float(fine.sigma.quantile(0.99))
    some = (
        (coarse.points[old], coarse.sigma[old], "the grid's points with $\\sigma > 0$"),
        (making.drawn, None, "drawn from its distribution"),
        (fine.points[new], fine.sigma[new], "the last level's points with $\\sigma > 0$"),
    )
    for axis, (points, sigma, what) in zip(axes, some, strict=True):
        shade = np.full(len(points), 0.45) if sigma is None else sigma.numpy() / top
        picture(axis, _seen(making, points, shade), f"{len(points):,} points:\n{what}")
    legend(drawn, axes[2], "viridis", top, r"density $\sigma$, 1 / radius of the region")
    return drawn


def _seen(making: Making, points: Float32[Tensor, "m 3"], shade: np.ndarray) -> np.ndarray:
    colours = tinted(shade, "viridis", 1.0)
    return splat(making.in_mm(points), colours, making.posed.cameras, making.view, SIZE)
