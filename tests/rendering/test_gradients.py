"""The way back of the compiled kernels against finite differences of their way there: float32."""

from collections.abc import Callable

import pytest
import torch
from torch import Tensor

from tests.finite_differences import directional_derivative
from tests.rendering.scene_renderers import scene_renderer, to_renderer_order
from tests.rendering.scenes import SCENES, RenderScene

Loss = Callable[[Tensor], Tensor]


def make_loss(scene: RenderScene, leaf: int) -> tuple[Loss, Tensor, float]:
    """Random shares of all that is seen, as a function of the points' values (leaf 0) or colors
    (1); where they are; and their unit.

    The depth is counted where most of the light is stopped: elsewhere, 1 - T may come near 0.
    """
    renderer, rays = scene_renderer(scene)
    options = [to_renderer_order(renderer, scene.sigma), to_renderer_order(renderer, scene.rgb)]
    shares = torch.randn(len(rays), 5, generator=torch.Generator().manual_seed(1)).double()
    firm = renderer.render(rays, *options).transmittance < 0.5

    def loss(values: Tensor) -> Tensor:
        inputs = [*options[:leaf], values, *options[leaf + 1 :]]
        rendered = renderer.render(rays, *inputs)
        columns = [rendered.transmittance[:, None], rendered.depth.where(firm, 0)[:, None]]
        return (torch.cat([rendered.color, *columns], dim=1).double() * shares).sum()

    return loss, options[leaf], (renderer.beta or 1.0) if leaf == 0 else 1.0


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize(("leaf", "h", "within"), [(0, 0.05, 2e-3), (1, 0.5, 1e-5)])
def test_gradients_are_slopes(name, leaf, h, within):
    """Along random ways the slope is about as large as the gradient, which errors are shares of.

    Values: 200 outputs, each a hundred roundings of 6e-8 off, make some 1e-5 of error in the loss
    and 3e-4 in its slope, and five-point differences leave as much.  Colors: the loss is linear in
    them, so h may be large.  No ray ends early, for there pixels jump.
    """
    loss, values, unit = make_loss(SCENES[name].with_settings(early_stop_transmittance=0.0), leaf)
    values = values.requires_grad_()
    (gradient,) = torch.autograd.grad(loss(values), values)
    generator, values = torch.Generator().manual_seed(2), values.detach()
    for _ in range(5):
        direction = torch.randn(values.shape, generator=generator)
        error = (
            directional_derivative(loss, values, direction, h * unit)
            - (gradient * direction).double().sum()
        )
        assert error.abs() <= within * gradient.norm()
