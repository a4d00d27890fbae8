"""Stands in for the method: as many points as steps, each from the seed and its number.

`AT` maps a step to something that happens before it; `SEEN` holds what the last call was given.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Float32, Int16, UInt8

from industnerf.artifacts.renderings import Renderings
from industnerf.geometry.cameras import Cameras

AT: dict[int, Callable[[], None]] = {}
SEEN: dict[str, Any] = {}


@dataclass(frozen=True)
class Posed:
    rgb: UInt8[np.ndarray, "n h w 3"]
    cameras: Cameras
    background: Float[np.ndarray, "n 3"] | None
    centre: Float[np.ndarray, "3"]
    radius: float


class Watch:
    def begin(self, level: str, steps: int) -> None: ...

    def step(self, loss: torch.Tensor) -> None: ...

    def wants_preview(self) -> bool:
        return False

    def preview(
        self, source: UInt8[np.ndarray, "h w 3"], rendered: UInt8[np.ndarray, "h w 3"]
    ) -> None: ...

    def wants_checkpoint(self) -> bool:
        return False

    def checkpoint(self, state: dict) -> None: ...


@dataclass(frozen=True)
class Outcome:
    points: Float32[np.ndarray, "n 3"]
    colours: UInt8[np.ndarray, "n 3"]
    confidence: Float32[np.ndarray, "n"]
    view: Int16[np.ndarray, "n"]
    steps: int
    parameters: int
    background: Float[np.ndarray, "n 3"]

    def pictures(self, cameras: Cameras, background: Float[np.ndarray, "n 3"]) -> Renderings:
        """Each image is full of a wall, nearer than what the cameras look at: a solid in walls."""
        shape = (len(cameras), cameras.height, cameras.width)
        away = np.linalg.norm(cameras.eyes - self.points.mean(axis=0), axis=1)
        depth = np.broadcast_to(0.8 * away[:, None, None], shape).astype(np.float32)
        return Renderings(np.zeros((*shape, 3), np.uint8), depth, np.full(shape, 255, np.uint8))


def run(
    posed: Posed, settings: Any, seed: int, watch: Watch | None = None, resume: dict | None = None
) -> Outcome:
    watch = watch or Watch()
    SEEN.update(posed=posed, settings=settings, seed=seed, resume=resume)
    points = resume["points"] if resume else torch.zeros((0, 3))
    watch.begin("coarse", settings.steps)
    for step in range(len(points), settings.steps):
        AT.get(step, lambda: None)()
        drawn = np.random.default_rng([seed, step]).uniform(-1, 1, (1, 3)) * posed.radius
        points = torch.cat([points, torch.tensor(posed.centre + drawn, dtype=torch.float32)])
        watch.step(torch.tensor(1.0 / (step + 1)))
        if watch.wants_preview():
            watch.preview(posed.rgb[0], 255 - posed.rgb[0])
        if watch.wants_checkpoint():
            watch.checkpoint({"points": points})
    n = len(points)
    return Outcome(
        points.numpy(),
        np.arange(3 * n, dtype=np.uint8).reshape(n, 3),
        np.linspace(0, 1, n, dtype=np.float32),
        (np.arange(n) % len(posed.rgb)).astype(np.int16),
        settings.steps,
        4,
        np.ones((len(posed.rgb), 3)),
    )
