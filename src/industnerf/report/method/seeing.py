"""Plates of section 3.3: one ray through the cloud, and a view rendered anew."""

from typing import Any

import numpy as np
import torch

from industnerf.rendering.confidence import colour_confidence, colour_scale
from industnerf.report.method.making import Making
from industnerf.report.method.profile import Profile, off_axis, profile
from industnerf.report.plates import figure, legend, picture

SURE = 0.9  # opacity of the pixel that is chosen for its ray
AROUND = 8.0  # spacings of cloud that are shown on either side of the ray
WORST = 0.3  # |I - O| at the end of the colour scale


def ray(making: Making) -> Any:
    """The radiance points of one ray: their density, T of eq. (10), and what each adds."""
    row, column = chosen_pixel(making)
    met = profile(making, row, column)
    drawn = figure(9, 4.6)
    left, right = drawn.subfigures(1, 2, width_ratios=(1, 2))
    axis = left.subplots()
    picture(axis, making.posed.rgb[making.view], "the ray's pixel")
    axis.scatter([column + 0.5], [row + 0.5], s=50, facecolors="none", edgecolors="#d1495b")
    top, bottom = right.subplots(2, 1, sharex=True)
    _beside(top, making, met)
    _along(bottom, making, met)
    return drawn


def chosen_pixel(making: Making) -> tuple[int, int]:
    """Row and column of the opaque pixel nearest to the middle of the opaque ones."""
    opaque = np.argwhere(making.rendered.opacity[0] >= SURE * 255)
    if not len(opaque):
        return making.posed.cameras.height // 2, making.posed.cameras.width // 2
    middle = opaque.mean(axis=0)
    row, column = opaque[np.argmin(((opaque - middle) ** 2).sum(axis=1))]
    return int(row), int(column)


def _beside(axis: Any, making: Making, met: Profile) -> None:
    """The cloud in a thin slab that holds the ray."""
    fine = making.fine
    away = fine.points - met.origin
    up = torch.linalg.cross(met.direction, away.new_tensor([0.0, 0.0, 1.0]))
    across = torch.linalg.cross(met.direction, up / up.norm())
    t, side = away @ met.direction, away @ across
    near = off_axis(fine.points, met.origin, met.direction) < AROUND * fine.spacing
    flat = ((away @ (up / up.norm())).abs() < fine.spacing) & near & (fine.sigma > 0)
    beside = side[flat].numpy() / fine.spacing
    axis.scatter(t[flat].numpy(), beside, s=4, c=fine.rgb[flat].numpy())
    axis.axhline(0, color="#4c6a92", linewidth=0.6)
    sizes = 4 + 150 * met.weights.numpy()
    axis.scatter(met.t.numpy(), 0 * sizes, s=sizes, color="#d1495b", zorder=3)
    axis.set_ylabel("cloud points beside\nthe ray, spacings", fontsize=7)
    axis.tick_params(labelsize=6)
    axis.set_title("radiance points (red, area: weight) among the cloud points", fontsize=8)


def _along(axis: Any, making: Making, met: Profile) -> None:
    """sigma, T and T alpha of the samples."""
    width = making.settings.fine_step * making.fine.spacing
    t, left, adds, sigma = (x.numpy() for x in (met.t, met.transmittance, met.weights, met.sigma))
    colours = met.rgb.clamp(0, 1).numpy()  # means of colours, which round
    axis.bar(t, adds, width, color=colours, edgecolor="#333333")
    axis.step(t - width / 2, left, where="post", color="#d1495b", label="T (10)")
    axis.plot([], [], "s", color="#aaaaaa", label=r"T $\alpha$, in the sample's colour")
    axis.set_ylim(0, 1.05)
    axis.set_xlabel("t along the ray, radii of the region", fontsize=7)
    other = axis.twinx()
    other.plot(t, sigma, ".-", markersize=2, linewidth=0.7, color="#4c6a92")
    other.set_ylabel(r"density $\sigma$", color="#4c6a92", fontsize=7)
    axis.legend(fontsize=6, loc="center right")
    for one in (axis, other):
        one.tick_params(labelsize=6)


def rerendered(making: Making) -> Any:
    """A source view beside its re-rendering: what training lowers, and S of eq. (12)."""
    seen = making.posed.rgb[making.view], making.rendered.rgb[0]
    photo, again = (torch.from_numpy(pixels.reshape(-1, 3) / 255.0) for pixels in seen)
    shape = seen[0].shape[:2]
    error = (photo - again).norm(dim=1).reshape(shape).numpy()
    contrast = float((photo.amax(0) - photo.amin(0)).norm())
    scale = colour_scale(making.settings.readings.scale, contrast)
    agreement = colour_confidence(photo, again, scale).reshape(shape).numpy()
    drawn = figure(9, 2.9)
    axes = drawn.subplots(1, 4)
    picture(axes[0], seen[0], "source view I")
    picture(axes[1], seen[1], "rendered anew, O")
    picture(axes[2], error, "|I - O|", cmap="magma", vmin=0, vmax=WORST)
    picture(axes[3], agreement, f"(12)  S, with L = {scale:.2f}", cmap="viridis", vmin=0, vmax=1)
    legend(drawn, axes[2], "magma", WORST, "")
    legend(drawn, axes[3], "viridis", 1.0, "")
    return drawn
