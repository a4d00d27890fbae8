"""The density of a signed distance, against what it promises in closed form."""

import math

import pytest
import torch

from industnerf.rendering.compiled_renderer import CompiledRenderer
from industnerf.rendering.points import PointGrid
from industnerf.rendering.render import Rays
from industnerf.rendering.sdf_density import CUTOFF_BETAS, SIGMOID_CUTOFF, density, sdf_to_density
from tests.rendering.point_grids import f64


def test_it_falls_from_1_over_beta_to_nothing():
    result = sdf_to_density(f64(-1e3, 0.0, 0.3 * CUTOFF_BETAS, 1e3), 0.3)
    rest = 1 / (1 + math.exp(-CUTOFF_BETAS))  # of the logistic function, without what is cut off
    assert result[0].item() == pytest.approx(rest / 0.3, rel=1e-12)
    assert result[1].item() == pytest.approx((0.5 - SIGMOID_CUTOFF) / 0.3, rel=1e-12)
    assert result[2:].tolist() == [0, 0]


def test_faint_is_the_logistic_function_at_minus_reach():
    assert pytest.approx(1 / (1 + math.exp(CUTOFF_BETAS)), rel=1e-15) == SIGMOID_CUTOFF


def test_without_beta_a_value_is_its_density():
    assert density(f64(0.0, 2.5), 0.0).tolist() == [0, 2.5]


def test_its_gradient_is_right():
    values = f64(-1.0, -0.2, 0.0, 0.3, 1.0).requires_grad_()
    assert torch.autograd.gradcheck(lambda x: density(x, 0.4), values)


@pytest.mark.parametrize("spacings", [0.4, 1.0, 2.0])
def test_a_plane_is_seen_where_its_distance_is_0(spacings):
    """Half of the light is left at the surface, whatever the softness.

    Tents are exact on a linear field.  The cut at 6 beta and behind the last point takes less
    than 2 % of the light, a step of a tenth of the spacing is exact to a hundredth of beta: one
    twentieth of a spacing is allowed, and twice the share of a soft one.
    """
    h = 0.025
    axis = torch.arange(-0.5, 0.5 + h / 2, h)
    points = PointGrid(torch.cartesian_prod(axis, axis, axis), 1.0001 * h, 8, "trilinear")
    renderer = CompiledRenderer(points, (-0.6,) * 3, (0.6,) * 3, 0.1 * h, 0.0)
    renderer.beta = spacings * h
    normal = torch.nn.functional.normalize(torch.tensor([1.0, 0.2, -0.1]), dim=0)
    values = points.positions @ normal - 0.013
    rays = Rays(2 * normal[None], -normal[None], torch.tensor([0.5]))
    rendered = renderer.render(rays, values, torch.ones(len(points), 3))
    assert 2 - rendered.median_depth.item() == pytest.approx(0.013, abs=0.05 * h * max(1, spacings))
