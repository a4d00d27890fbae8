"""A renderer of a scene of `scenes.py`, on a device, and back to the scene's order."""

import torch

from industnerf.rendering.points import PointGrid
from industnerf.rendering.render import Rays, Renderer, make_renderer
from industnerf.schema.industnerf import RendererName
from tests.rendering.scenes import RenderScene


def scene_renderer(
    scene: RenderScene, device: str = "cpu", name: RendererName = "compiled"
) -> tuple[Renderer, Rays]:
    scene, settings = scene.to(torch.float32), scene.settings
    points = PointGrid(
        scene.points.to(device), settings["radius"], settings["k"], settings["weights"]
    )
    box = tuple(scene.lo.tolist()), tuple(scene.hi.tolist())
    step, early_stop = settings["step"], settings["early_stop_transmittance"]
    renderer = make_renderer(name, points, *box, step, early_stop)
    renderer.beta = settings.get("beta", 0.0)
    rays = (scene.origins, scene.directions, scene.offsets)
    return renderer, Rays(*(values.to(device) for values in rays))


def to_renderer_order(renderer: Renderer, values: torch.Tensor) -> torch.Tensor:
    """Values of the points as they were given, for the renderer's."""
    order = renderer.points.order
    return values.float().to(order.device)[order]


def to_scene_order(renderer: Renderer, values: torch.Tensor) -> torch.Tensor:
    """Values of the renderer's points, for the points as they were given."""
    original = torch.empty_like(values)
    original[renderer.points.order] = values
    return original.double().cpu()
