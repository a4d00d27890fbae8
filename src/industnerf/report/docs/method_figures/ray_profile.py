"""The samples of one ray through the cloud, sample by sample: 3.3 and eq. (10)."""

from dataclasses import dataclass

import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.methods.industnerf.scene import torch_cameras
from industnerf.rendering.compositing import opacities, terminated_density, transmittance
from industnerf.rendering.samples import radiance_points
from industnerf.rendering.sdf_density import density
from industnerf.report.docs.method_figures.pipeline_trace import PipelineTrace


@dataclass(frozen=True)
class RayProfile:
    """A ray through a pixel; lengths in the unit frame."""

    origin: Float32[Tensor, "3"]
    direction: Float32[Tensor, "3"]
    t: Float32[Tensor, "s"]  # of the samples with a neighbor
    sigma: Float32[Tensor, "s"]
    rgb: Float32[Tensor, "s 3"]
    transmittance: Float32[Tensor, "s"]  # (10), before the sample
    weights: Float32[Tensor, "s"]  # T alpha


def trace_ray(trace: PipelineTrace, row: int, column: int) -> RayProfile:
    """The ray of pixel (row, column) of the chosen view, through the finished field."""
    fine, settings, images = trace.fine, trace.settings, trace.images
    cameras = torch_cameras(images.cameras, images.center, images.radius, torch.device("cpu"))
    uv = torch.tensor([[column + 0.5, row + 0.5]])
    view = torch.tensor([trace.view])
    rays = cameras.rays(view, uv, torch.full_like(uv[:, 0], 0.5))
    half_size, radius = 1 + fine.spacing, settings.neighbor_radius * fine.spacing
    support_diagonal = 3**0.5 * radius  # of the cube that trilinear weights reach
    nearby = (
        distance_to_line(fine.points, rays.origins[0], rays.directions[0]) < 1.01 * support_diagonal
    )
    cube = fine.points.new_full((3,), half_size)
    samples = radiance_points(
        *vars(rays).values(),
        -cube,
        cube,
        fine.points[nearby],
        step=settings.fine_step_size * fine.spacing,
        radius=radius,
        k=settings.neighbors,
        weights=settings.readings.interpolation,
    )
    has_neighbors = (samples.ids[0] >= 0).any(dim=1)
    field = samples.mean(torch.cat([fine.values[nearby, None], fine.rgb[nearby]], dim=1))[
        0, has_neighbors
    ]
    step = settings.fine_step_size * fine.spacing
    raw_sigma = density(field[:, 0], fine.beta)
    sigma = terminated_density(raw_sigma[None], step, settings.early_stop_transmittance)
    remaining = transmittance(sigma, step)[0, :-1]
    weights = remaining * opacities(sigma, step)[0]
    samples_on_ray = rays.origins[0], rays.directions[0], samples.t[0, has_neighbors]
    return RayProfile(*samples_on_ray, raw_sigma, field[:, 1:], remaining, weights)


def distance_to_line(
    points: Float32[Tensor, "m 3"], origin: Float32[Tensor, "3"], direction: Float32[Tensor, "3"]
) -> Float32[Tensor, "m"]:
    """Distance of each point to a line; the direction has unit length."""
    offsets = points - origin
    return (offsets - (offsets @ direction)[:, None] * direction).norm(dim=1)
