"""Pictures of the finished field from any camera: the held-out views of Table 2, previews."""

import numpy as np
import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.artifacts.renderings import Renderings
from industnerf.methods.industnerf.pixels import footprint
from industnerf.methods.industnerf.scene import Eyes
from industnerf.rendering.distance import density
from industnerf.rendering.render import Renderer


@torch.no_grad()
def rerender(
    eyes: Eyes,
    background: Float32[Tensor, "n 3"],
    renderer: Renderer,
    values: Float32[Tensor, "m"],
    rgb: Float32[Tensor, "m 3"],
    radius: float,
) -> Renderings:
    """Colour, opacity, and depth along z in the unit of `radius`, which is that of the unit ball.

    Depth is 0 where no surface is met.
    """
    n, height, width = len(eyes), eyes.height, eyes.width
    colour = background[:, None, None].expand(n, height, width, 3).clone()
    depth = torch.zeros(n, height, width, device=values.device)
    opacity = torch.zeros_like(depth)
    reach = renderer.points.reach
    softest = max(renderer.beta, renderer.median_beta)
    dense = density(values, softest) > 0
    shown = footprint(renderer.points.positions[dense], reach, eyes, max(height, width))
    for pixels in shown.nonzero().split(renderer.at_once):
        view, row, column = pixels.unbind(1)
        uv = torch.stack([column, row], dim=1) + 0.5
        rays = eyes.rays(view, uv, torch.full_like(uv[:, 0], 0.5))
        seen = renderer.look(rays, values, rgb)
        colour[view, row, column] = seen.over(background[view])
        ahead = (rays.directions * eyes.c2w[view, :3, 2]).sum(dim=1)
        hit = seen.median > 0
        depth[view, row, column] = torch.where(hit, seen.median * ahead * radius, 0.0)
        opacity[view, row, column] = 1 - seen.through
    return Renderings(_levels(colour), depth.cpu().numpy().astype(np.float32), _levels(opacity))


def _levels(values: Tensor) -> np.ndarray:
    return (values.clamp(0, 1) * 255).round().to(torch.uint8).cpu().numpy()
