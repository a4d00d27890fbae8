"""The compiled renderer on a scene of `scenes.py`, on a device, and back to the scene's order."""

import torch

from industnerf.rendering.points import Points
from industnerf.rendering.render import Rays, Renderer
from tests.rendering.scenes import Scene


def compiled(scene: Scene, device: str = "cpu") -> tuple[Renderer, Rays]:
    scene, ways = scene.to(torch.float32), scene.settings
    points = Points(scene.points.to(device), ways["radius"], ways["k"], ways["weights"])
    box = tuple(scene.lo.tolist()), tuple(scene.hi.tolist())
    renderer = Renderer(points, *box, ways["step"], ways["stop"])
    renderer.beta = ways.get("beta", 0.0)
    rays = (scene.origins, scene.directions, scene.offsets)
    return renderer, Rays(*(values.to(device) for values in rays))


def in_order(renderer: Renderer, values: torch.Tensor) -> torch.Tensor:
    """Values of the points as they were given, for the renderer's."""
    order = renderer.points.order
    return values.float().to(order.device)[order]


def back(renderer: Renderer, values: torch.Tensor) -> torch.Tensor:
    """Values of the renderer's points, for the points as they were given."""
    given = torch.empty_like(values)
    given[renderer.points.order] = values
    return given.double().cpu()
