"""Images of the trained field from any camera: the held-out views of Table 2, and previews."""

import numpy as np
import torch
from jaxtyping import Float, Float32
from torch import Tensor

from industnerf.artifacts.renderings import Renderings
from industnerf.geometry.cameras import Cameras
from industnerf.methods.industnerf.ray_sampler import footprint
from industnerf.methods.industnerf.scene import PosedImages, TorchCameras, torch_cameras
from industnerf.methods.industnerf.trainer import Trainer
from industnerf.rendering.render import Renderer
from industnerf.rendering.sdf_density import density

Background = Float[np.ndarray, "views 3"]


def render_views(
    trainer: Trainer, posed: PosedImages, cameras: Cameras, background: Background
) -> Renderings:
    """The trained field from `cameras`, over `background`; depth is in the cameras' unit.

    Color and opacity are as soft as trained, but for space that is empty for the hard surface,
    which is skipped.  Depth is that of the hard surface, and of the soft one in pixels that the
    hard one does not cover.
    """
    torch_device = trainer.points.positions.device
    background_colors = torch.tensor(background, dtype=torch.float32, device=torch_device)
    render_cameras = torch_cameras(cameras, posed.center, posed.radius, torch_device)
    renderer = trainer.fine_renderer(trainer.beta())
    return rerender(render_cameras, background_colors, renderer, *trainer.values(), posed.radius)


@torch.no_grad()
def rerender(
    cameras: TorchCameras,
    background: Float32[Tensor, "n 3"],
    renderer: Renderer,
    values: Float32[Tensor, "m"],
    rgb: Float32[Tensor, "m 3"],
    radius: float,
) -> Renderings:
    """Color, opacity, and depth along z; `radius` is the unit ball's, and sets the unit of depth.

    Depth is 0 where there is no surface.
    """
    n, height, width = len(cameras), cameras.height, cameras.width
    color = background[:, None, None].expand(n, height, width, 3).clone()
    depth = torch.zeros(n, height, width, device=values.device)
    opacity = torch.zeros_like(depth)
    support_radius = renderer.points.support_radius
    max_beta = max(renderer.beta, renderer.median_beta)
    has_density = density(values, max_beta) > 0
    visible = footprint(
        renderer.points.positions[has_density], support_radius, cameras, max(height, width)
    )
    for pixels in visible.nonzero().split(renderer.chunk_size):
        view, row, column = pixels.unbind(1)
        uv = torch.stack([column, row], dim=1) + 0.5
        rays = cameras.rays(view, uv, torch.full_like(uv[:, 0], 0.5))
        output = renderer.render(rays, values, rgb)
        color[view, row, column] = output.composite_over(background[view])
        axis_cosine = (rays.directions * cameras.c2w[view, :3, 2]).sum(dim=1)
        hit = output.median_depth > 0
        depth[view, row, column] = torch.where(hit, output.median_depth * axis_cosine * radius, 0.0)
        opacity[view, row, column] = 1 - output.transmittance
    return Renderings(_to_uint8(color), depth.cpu().numpy().astype(np.float32), _to_uint8(opacity))


def _to_uint8(values: Tensor) -> np.ndarray:
    return (values.clamp(0, 1) * 255).round().to(torch.uint8).cpu().numpy()
