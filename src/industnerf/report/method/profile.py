"""What one ray meets on its way through the cloud, sample by sample: 3.3 and eq. (10)."""

from dataclasses import dataclass

import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.methods.industnerf.scene import eyes
from industnerf.rendering.compositing import opacities, stopped, transmittance
from industnerf.rendering.distance import density
from industnerf.rendering.samples import radiance_points
from industnerf.report.method.making import Making


@dataclass(frozen=True)
class Profile:
    """A ray through a pixel; lengths in the unit frame."""

    origin: Float32[Tensor, "3"]
    direction: Float32[Tensor, "3"]
    t: Float32[Tensor, "s"]  # of the samples with a neighbour
    sigma: Float32[Tensor, "s"]
    rgb: Float32[Tensor, "s 3"]
    transmittance: Float32[Tensor, "s"]  # (10), before the sample
    weights: Float32[Tensor, "s"]  # T alpha


def profile(making: Making, row: int, column: int) -> Profile:
    """The ray of pixel (row, column) of the chosen view, through the finished field."""
    fine, ways, posed = making.fine, making.settings, making.posed
    looking = eyes(posed.cameras, posed.centre, posed.radius, torch.device("cpu"))
    uv = torch.tensor([[column + 0.5, row + 0.5]])
    view = torch.tensor([making.view])
    rays = looking.rays(view, uv, torch.full_like(uv[:, 0], 0.5))
    side, radius = 1 + fine.spacing, ways.radius * fine.spacing
    corner = 3**0.5 * radius  # the farthest that a neighbour can be, of a tent
    close = off_axis(fine.points, rays.origins[0], rays.directions[0]) < 1.01 * corner
    cube = fine.points.new_full((3,), side)
    samples = radiance_points(
        *vars(rays).values(),
        -cube,
        cube,
        fine.points[close],
        step=ways.fine_step * fine.spacing,
        radius=radius,
        k=ways.neighbours,
        weights=ways.readings.weights,
    )
    met = (samples.ids[0] >= 0).any(dim=1)
    field = samples.mean(torch.cat([fine.values[close, None], fine.rgb[close]], dim=1))[0, met]
    step = ways.fine_step * fine.spacing
    dense = density(field[:, 0], fine.beta)
    sigma = stopped(dense[None], step, ways.stop)
    left = transmittance(sigma, step)[0, :-1]
    weights = left * opacities(sigma, step)[0]
    at = rays.origins[0], rays.directions[0], samples.t[0, met]
    return Profile(*at, dense, field[:, 1:], left, weights)


def off_axis(
    points: Float32[Tensor, "m 3"], origin: Float32[Tensor, "3"], direction: Float32[Tensor, "3"]
) -> Float32[Tensor, "m"]:
    """Distance of each point to a line; the direction has unit length."""
    away = points - origin
    return (away - (away @ direction)[:, None] * direction).norm(dim=1)
