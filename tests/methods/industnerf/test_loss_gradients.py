"""All that a step of training goes by, from outside: the gradient that it leaves on the points is
the slope of the loss as it is written here, by finite differences of what the renderer sees.
"""

from dataclasses import replace
from functools import partial
from typing import Any

import pytest
import torch
from torch import Tensor

from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.network import activate
from industnerf.methods.industnerf.point_levels import PointLevel, grid_spacing, initial_grid
from industnerf.methods.industnerf.scene import NerfScene
from industnerf.methods.industnerf.trainer import Trainer
from tests.finite_differences import directional_derivative
from tests.methods.industnerf.synthetic_scenes import (
    CPU,
    FREE_POINTS,
    ball,
    make_test_scene,
    settings,
)

RES, WITHIN = 12, 2e-4  # a share of the gradient
NEAR, FAR, NONE = 2.0, 6.0, 0.0  # readings of depth: before and behind all points, and without one
TERMS = {
    "error": {},
    "opacity_weight": {"opacity_weight": 2.0},
    "binary_opacity_weight": {"binary_opacity_weight": 2.0},
    "depth": {"depth_weight": 2.0},
    "all": {"opacity_weight": 0.1, "binary_opacity_weight": 0.3, "depth_weight": 0.5},
}


def scene_with_depth() -> NerfScene:
    """A ball in four views, with readings of depth at random."""
    views, generator = make_test_scene(ball(18.0), 4, 32), torch.Generator().manual_seed(3)
    choice = torch.randint(3, views.images.shape[:3], generator=generator)
    return replace(views, depth=torch.tensor([NEAR, FAR, NONE])[choice])


def make_trainer(**weights: float) -> tuple[Trainer, torch.Generator]:
    """Of free points that are half transparent and colored at random; and what it draws pixels by.

    No ray ends early, for there pixels jump.
    """
    weights_or_zero: dict[str, Any] = {
        "opacity_weight": 0.0,
        "binary_opacity_weight": 0.0,
        "depth_weight": 0.0,
        "early_stop_transmittance": 0.0,
    } | weights
    config = settings("industnerf_depth", grid_res=RES, **FREE_POINTS, **weights_or_zero)
    views = scene_with_depth()
    points, generator = initial_grid(grid_spacing(RES, 0), CPU), torch.Generator().manual_seed(4)
    initial = torch.rand(len(points), 4, generator=generator)
    level = PointLevel(
        points, grid_spacing(RES, 0), (3 * initial[:, 0] - 3, 0.2 + 0.6 * initial[:, 1:])
    )
    return Trainer(views, Field(views, config), level, 0, config, generator), generator


def reference_loss(trainer: Trainer, pixels: tuple[Tensor, Tensor], row: Tensor) -> Tensor:
    """The loss of the pixels `drawn`, of points with the raw density and color in `row`."""
    settings, (rays, target, background) = trainer.settings, trainer.ray_sampler.rays(*pixels)
    sigma = activate(row[:, 0], "truncated_exp", grid_spacing(RES, 0), settings.max_raw_density)
    output = trainer.renderer.render(rays, sigma, row[:, 1:].contiguous())
    transmittance = output.transmittance.double()
    measured = trainer.ray_sampler.ray_depths(pixels[0], rays).double()
    photometric = (output.color + transmittance[:, None] * background - target).square().mean()
    depth_error = (1 - transmittance) * (output.depth - measured).abs() + transmittance
    return (
        photometric
        + settings.opacity_weight * (1 - transmittance).mean()
        + settings.binary_opacity_weight * (transmittance - transmittance**2).mean()
        + settings.depth_weight * (depth_error * (measured > 0)).mean()
    )


@pytest.mark.parametrize("terms", TERMS)
def test_the_gradient_of_a_step_is_the_slope_of_the_loss(terms):
    """Readings are before or behind all points: no kink is near.  256 rays of some 20 roundings of
    6e-8 are off by 1e-7 in the mean, and their slope, which is 1e-2, by 3e-6."""
    trainer, generator = make_trainer(**TERMS[terms])
    pixel_generator = torch.Generator()
    pixel_generator.set_state(generator.get_state())  # pixels are the first that a step draws
    pixels = trainer.ray_sampler.sample_pixels(trainer.settings.rays_per_step, pixel_generator)
    raw, rgb = trainer.field.point_parameters()
    row = torch.cat([raw[:, None], rgb], dim=1).detach().clone()
    trainer.step()
    gradient = torch.cat([raw.grad[:, None], rgb.grad], dim=1).double()
    direction_generator = torch.Generator().manual_seed(5)
    for part in (slice(0, 1), slice(1, 4)):
        direction = torch.zeros_like(row)
        direction[:, part] = torch.randn(direction[:, part].shape, generator=direction_generator)
        actual = directional_derivative(
            partial(reference_loss, trainer, pixels), row, direction, 0.05
        )
        assert (actual - (gradient * direction).sum()).abs() < WITHIN * gradient[:, part].norm()
