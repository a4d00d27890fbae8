"""The renderer once more, one ray, one sample and one number at a time, with scipy's tree."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import torch
from scipy.spatial import cKDTree

from industnerf.rendering.compositing import Rendered
from tests.rendering.scenes import Scene


@dataclass
class Step:
    """A sample that has neighbours."""

    ray: int
    t: float
    neighbours: dict[int, float]  # and their weights
    before: float  # transmittance
    alpha: float


def march(scene: Scene) -> Iterator[Step]:
    """Every ray until it leaves the cube or has less than `stop` left."""
    points, sigma = scene.points.numpy(), scene.sigma.numpy()
    tree, how = cKDTree(points), scene.settings
    for ray, (o, d) in enumerate(zip(scene.origins.numpy(), scene.directions.numpy(), strict=True)):
        t_in, t_out = _span(o, d, scene.lo.numpy(), scene.hi.numpy())
        q, left = 0, 1.0
        while (t := t_in + (q + scene.offsets[ray].item()) * how["step"]) < t_out:
            q += 1
            near = _near(tree, o + t * d, how)
            if not near:
                continue
            held = sum(w * sigma[j] for j, w in near.items()) / sum(near.values())
            alpha = 1 - math.exp(-_density(held, how.get("beta", 0.0)) * how["step"])
            yield Step(ray, t, near, left, alpha)
            left *= 1 - alpha
            if left < how["stop"]:
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


def _density(held: float, beta: float) -> float:
    """Of what points hold: a density, or if there is a `beta` a signed distance."""
    if not beta:
        return held
    return max(1 / (1 + math.exp(held / beta)) - 1 / (1 + math.exp(6)), 0) / beta


def _near(tree: cKDTree, x: np.ndarray, how: dict) -> dict[int, float]:
    radius, floor = how["radius"], 1e-3 * how["radius"]
    if how["weights"] == "tent":
        found = zip(*tree.query(x, range(1, how["k"] + 1), p=math.inf), strict=True)
        near = [int(j) for d, j in found if d < radius]
        return {j: math.prod(1 - abs(a) / radius for a in tree.data[j] - x) for j in near}
    found = zip(*tree.query(x, k=range(1, how["k"] + 1), distance_upper_bound=radius), strict=True)
    weigh = {
        "inverse": lambda d: 1 / max(d, floor),
        "inverse_square": lambda d: 1 / max(d, floor) ** 2,
        "tapered": lambda d: ((radius - d) / (radius * max(d, floor))) ** 2,
    }[how["weights"]]
    return {int(j): weigh(d) for d, j in found if d < radius}


def render_loops(scene: Scene) -> Rendered:
    """What `render_twin` returns."""
    rays = len(scene.origins)
    pixel, depth, left = torch.zeros(rays, 3).double(), torch.zeros(rays).double(), [1.0] * rays
    for step in march(scene):
        total = sum(step.neighbours.values())
        colour = sum(w / total * scene.rgb[j] for j, w in step.neighbours.items())
        pixel[step.ray] += step.before * step.alpha * colour
        depth[step.ray] += step.before * step.alpha * step.t
        left[step.ray] = step.before * (1 - step.alpha)
    end = torch.tensor(left, dtype=torch.float64)
    opacity = 1 - end
    return Rendered(
        pixel + end[:, None] * scene.background, opacity, depth / opacity.clamp(min=1e-8)
    )


def confidence_loops(
    scene: Scene, steps: list[Step], transmittance: str, opacity: str, samples: str
) -> torch.Tensor:
    """What `confidence_twin` returns, from all steps of `march`."""
    result = torch.zeros_like(scene.sigma)
    for step in steps:
        through = step.before * (1 - step.alpha if transmittance == "own" else 1)
        value = scene.agreement[step.ray] * through * (step.alpha if opacity == "with" else 1)
        for j, w in step.neighbours.items():
            given = value * w / max(step.neighbours.values())
            result[j] = max(result[j], given) if samples == "max" else result[j] + given
    return result
