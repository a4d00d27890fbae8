"""The renderer once more, one ray, one sample and one number at a time, with scipy's tree."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import torch
from scipy.spatial import cKDTree

from industnerf.rendering.compositing import CompositeOutput
from tests.rendering.scenes import RenderScene


@dataclass
class Sample:
    """A sample that has neighbors."""

    ray: int
    t: float
    neighbors: dict[int, float]  # and their weights
    transmittance: float  # transmittance
    alpha: float


def march_rays(scene: RenderScene) -> Iterator[Sample]:
    """Every ray until it leaves the cube or has less than `stop` left."""
    points, sigma = scene.points.numpy(), scene.sigma.numpy()
    tree, settings = cKDTree(points), scene.settings
    for ray, (o, d) in enumerate(zip(scene.origins.numpy(), scene.directions.numpy(), strict=True)):
        t_in, t_out = _span(o, d, scene.lo.numpy(), scene.hi.numpy())
        q, transmittance = 0, 1.0
        while (t := t_in + (q + scene.offsets[ray].item()) * settings["step"]) < t_out:
            q += 1
            neighbors = _neighbor_weights(tree, o + t * d, settings)
            if not neighbors:
                continue
            value = sum(w * sigma[j] for j, w in neighbors.items()) / sum(neighbors.values())
            alpha = 1 - math.exp(-_density(value, settings.get("beta", 0.0)) * settings["step"])
            yield Sample(ray, t, neighbors, transmittance, alpha)
            transmittance *= 1 - alpha
            if transmittance < settings["early_stop_transmittance"]:
                break


def _span(o: np.ndarray, d: np.ndarray, lo: np.ndarray, hi: np.ndarray) -> tuple[float, float]:
    enter, leave = 0.0, math.inf
    for axis in range(3):
        if d[axis] == 0:
            if not lo[axis] <= o[axis] < hi[axis]:
                return 0.0, 0.0
            continue
        a, b = sorted(((lo[axis] - o[axis]) / d[axis], (hi[axis] - o[axis]) / d[axis]))
        enter, leave = max(enter, a), min(leave, b)
    return enter, leave


def _density(value: float, beta: float) -> float:
    """Of what points hold: a density, or if there is a `beta` a signed distance."""
    if not beta:
        return value
    return max(1 / (1 + math.exp(value / beta)) - 1 / (1 + math.exp(6)), 0) / beta


def _neighbor_weights(tree: cKDTree, x: np.ndarray, settings: dict) -> dict[int, float]:
    radius, floor = settings["radius"], 1e-3 * settings["radius"]
    if settings["weights"] == "trilinear":
        candidates = zip(*tree.query(x, range(1, settings["k"] + 1), p=math.inf), strict=True)
        inside = [int(j) for d, j in candidates if d < radius]
        return {j: math.prod(1 - abs(a) / radius for a in tree.data[j] - x) for j in inside}
    candidates = zip(
        *tree.query(x, k=range(1, settings["k"] + 1), distance_upper_bound=radius), strict=True
    )
    weigh = {
        "inverse": lambda d: 1 / max(d, floor),
        "inverse_square": lambda d: 1 / max(d, floor) ** 2,
        "modified_shepard": lambda d: ((radius - d) / (radius * max(d, floor))) ** 2,
    }[settings["weights"]]
    return {int(j): weigh(d) for d, j in candidates if d < radius}


def render_loops(scene: RenderScene) -> CompositeOutput:
    """What `render_reference` returns."""
    rays = len(scene.origins)
    pixel = torch.zeros(rays, 3).double()
    depth = torch.zeros(rays).double()
    transmittance_end = [1.0] * rays
    for step in march_rays(scene):
        total = sum(step.neighbors.values())
        color = sum(w / total * scene.rgb[j] for j, w in step.neighbors.items())
        pixel[step.ray] += step.transmittance * step.alpha * color
        depth[step.ray] += step.transmittance * step.alpha * step.t
        transmittance_end[step.ray] = step.transmittance * (1 - step.alpha)
    end = torch.tensor(transmittance_end, dtype=torch.float64)
    opacity = 1 - end
    return CompositeOutput(
        pixel + end[:, None] * scene.background, opacity, depth / opacity.clamp(min=1e-8)
    )


def confidence_loops(
    scene: RenderScene, steps: list[Sample], transmittance: str, opacity: str, samples: str
) -> torch.Tensor:
    """What `confidence_reference` returns, from all steps of `march`."""
    result = torch.zeros_like(scene.sigma)
    for step in steps:
        visibility = step.transmittance * (1 - step.alpha if transmittance == "own" else 1)
        value = scene.agreement[step.ray] * visibility * (step.alpha if opacity == "with" else 1)
        for j, w in step.neighbors.items():
            contribution = value * w / max(step.neighbors.values())
            result[j] = (
                max(result[j], contribution) if samples == "max" else result[j] + contribution
            )
    return result
