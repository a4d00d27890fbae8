"""The kernels on a GPU against the same on the CPU.

One source is compiled for both: they differ in roundings, in the order in which gradients are
added, and in how points of one cell are sorted.
"""

import pytest
import torch
from torch import Tensor

from tests.rendering.compiled import back, compiled, in_order
from tests.rendering.scenes import SCENES, Scene

GPU = "cuda"
needs_gpu = pytest.mark.skipif(
    not torch.cuda.is_available(),
    reason="no CUDA device: that a GPU sees, learns and believes what the CPU does is untested",
)


def told(scene: Scene, device: str) -> dict[str, Tensor]:
    """All that the renderer says of a scene: what is seen, its gradients, and confidence."""
    renderer, rays = compiled(scene, device)
    values, rgb = (in_order(renderer, x).requires_grad_() for x in (scene.sigma, scene.rgb))
    seen = renderer.look(rays, values, rgb)
    firm = seen.through < 0.5  # elsewhere the depth is divided by a 1 - T that cancels
    depth, median = seen.depth.where(firm, 0), seen.median.where(seen.through < 0.4, 0)
    shares = torch.linspace(-1, 1, 3 * len(rays), device=device).reshape(-1, 3)
    ((seen.colour * shares).sum() + (seen.through - depth) @ shares[:, 1]).backward()
    sure, agreement = torch.zeros_like(rgb[:, 0]), scene.agreement.float().to(device)
    renderer.confide(values, agreement, sure, transmittance="shared", opacity="with", samples="max")
    of_rays = {"colour": seen.colour, "through": seen.through, "depth": depth, "median": median}
    of_points = {"values": values.grad, "rgb": rgb.grad, "confidence": sure}
    return {name: x.detach().double().cpu() for name, x in of_rays.items()} | {
        name: back(renderer, x.detach()) for name, x in of_points.items()
    }


@needs_gpu
@pytest.mark.parametrize("name", SCENES)
def test_a_gpu_sees_and_learns_and_believes_the_same(name):
    """Within 1e-4 of each value, or of the largest of its kind, which gradients are sums beside."""
    here, there = (told(SCENES[name], device) for device in ("cpu", GPU))
    for kind, truth in here.items():
        least = 1e-4 * truth.abs().max().item()
        torch.testing.assert_close(there[kind], truth, rtol=1e-4, atol=least)
