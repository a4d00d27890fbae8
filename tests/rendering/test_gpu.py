"""The kernels on a GPU against the same on the CPU.

One source is compiled for both: they differ in roundings, in the order in which gradients are
added, and in how points of one cell are sorted.
"""

import pytest
import torch
from torch import Tensor

from tests.rendering.scene_renderers import scene_renderer, to_renderer_order, to_scene_order
from tests.rendering.scenes import SCENES, RenderScene

GPU = "cuda"
needs_gpu = pytest.mark.skipif(
    not torch.cuda.is_available(),
    reason="no CUDA device: that a GPU sees, learns and believes what the CPU does is untested",
)


def rendered_outputs(scene: RenderScene, device: str) -> dict[str, Tensor]:
    """All that the renderer says of a scene: what is seen, its gradients, and confidence."""
    renderer, rays = scene_renderer(scene, device)
    values, rgb = (
        to_renderer_order(renderer, x).requires_grad_() for x in (scene.sigma, scene.rgb)
    )
    output = renderer.render(rays, values, rgb)
    firm = output.transmittance < 0.5  # elsewhere the depth is divided by a 1 - T that cancels
    depth = output.depth.where(firm, 0)
    median = output.median_depth.where(output.transmittance < 0.4, 0)
    shares = torch.linspace(-1, 1, 3 * len(rays), device=device).reshape(-1, 3)
    ((output.color * shares).sum() + (output.transmittance - depth) @ shares[:, 1]).backward()
    confidence, agreement = torch.zeros_like(rgb[:, 0]), scene.agreement.float().to(device)
    renderer.accumulate_confidence(
        values, agreement, confidence, transmittance="shared", opacity="with", samples="max"
    )
    of_rays = {
        "color": output.color,
        "transmittance": output.transmittance,
        "depth": depth,
        "median_depth": median,
    }
    of_points = {"values": values.grad, "rgb": rgb.grad, "confidence": confidence}
    return {name: x.detach().double().cpu() for name, x in of_rays.items()} | {
        name: to_scene_order(renderer, x.detach()) for name, x in of_points.items()
    }


@needs_gpu
@pytest.mark.parametrize("name", SCENES)
def test_a_gpu_sees_and_learns_and_believes_the_same(name):
    """Within 1e-4 of each value, or of the largest of its kind, which gradients are sums beside."""
    on_cpu, on_gpu = (rendered_outputs(SCENES[name], device) for device in ("cpu", GPU))
    for kind, truth in on_cpu.items():
        minimum = 1e-4 * truth.abs().max().item()
        torch.testing.assert_close(on_gpu[kind], truth, rtol=1e-4, atol=minimum)
