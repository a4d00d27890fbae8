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
from industnerf.methods.industnerf.levels import Layer, grid, spacing_of
from industnerf.methods.industnerf.network import activate
from industnerf.methods.industnerf.scene import Scene
from industnerf.methods.industnerf.training import Training
from tests.methods.industnerf.scenes import CPU, FREE, ball, scene, settings
from tests.slopes import slope

RES, WITHIN = 12, 2e-4  # a share of the gradient
NEAR, FAR, NONE = 2.0, 6.0, 0.0  # readings of depth: before and behind all points, and without one
TERMS = {
    "error": {},
    "emptiness": {"emptiness": 2.0},
    "veil": {"veil": 2.0},
    "depth": {"depth": 2.0},
    "all": {"emptiness": 0.1, "veil": 0.3, "depth": 0.5},
}


def read_scene() -> Scene:
    """A ball in four views, with readings of depth at random."""
    seen, generator = scene(ball(18.0), 4, 32), torch.Generator().manual_seed(3)
    which = torch.randint(3, seen.images.shape[:3], generator=generator)
    return replace(seen, depth=torch.tensor([NEAR, FAR, NONE])[which])


def a_training(**weights: float) -> tuple[Training, torch.Generator]:
    """Of free points that are half transparent and coloured at random; and what it draws pixels by.

    No ray ends early, for there pixels jump.
    """
    others: dict[str, Any] = {"emptiness": 0.0, "veil": 0.0, "depth": 0.0, "stop": 0.0} | weights
    ways, seen = settings("industnerf", grid_res=RES, **FREE, **others), read_scene()
    points, generator = grid(spacing_of(RES, 0), CPU), torch.Generator().manual_seed(4)
    start = torch.rand(len(points), 4, generator=generator)
    layer = Layer(points, spacing_of(RES, 0), (3 * start[:, 0] - 3, 0.2 + 0.6 * start[:, 1:]))
    return Training(seen, Field(seen, ways), layer, 0, ways, generator), generator


def written(training: Training, drawn: tuple[Tensor, Tensor], row: Tensor) -> Tensor:
    """The loss of the pixels `drawn`, of points with the raw density and colour in `row`."""
    ways, (rays, target, background) = training.ways, training.pixels.rays(*drawn)
    sigma = activate(row[:, 0], "cut_exp", spacing_of(RES, 0), ways.ceiling)
    seen = training.renderer.look(rays, sigma, row[:, 1:].contiguous())
    left, read = seen.through.double(), training.pixels.distances(drawn[0], rays).double()
    error = (seen.colour + left[:, None] * background - target).square().mean()
    missed = (1 - left) * (seen.depth - read).abs() + left
    return (
        error
        + ways.emptiness * (1 - left).mean()
        + ways.veil * (left - left**2).mean()
        + ways.depth * (missed * (read > 0)).mean()
    )


@pytest.mark.parametrize("terms", TERMS)
def test_the_gradient_of_a_step_is_the_slope_of_the_loss(terms):
    """Readings are before or behind all points: no kink is near.  256 rays of some 20 roundings of
    6e-8 are off by 1e-7 in the mean, and their slope, which is 1e-2, by 3e-6."""
    training, generator = a_training(**TERMS[terms])
    draws = torch.Generator()
    draws.set_state(generator.get_state())  # pixels are the first that a step draws
    drawn = training.pixels.draw(training.ways.rays, draws)
    raw, rgb = training.field.own()
    row = torch.cat([raw[:, None], rgb], dim=1).detach().clone()
    training.step()
    gradient = torch.cat([raw.grad[:, None], rgb.grad], dim=1).double()
    ways = torch.Generator().manual_seed(5)
    for part in (slice(0, 1), slice(1, 4)):
        way = torch.zeros_like(row)
        way[:, part] = torch.randn(way[:, part].shape, generator=ways)
        found = slope(partial(written, training, drawn), row, way, 0.05)
        assert (found - (gradient * way).sum()).abs() < WITHIN * gradient[:, part].norm()
