"""Stands in for the method: as many points as steps, each from the seed and its number.

`HOOKS` maps a step to what happens before it; `LAST_CALL` holds the arguments of the last call.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Float32, Int16, UInt8

from industnerf.artifacts.renderings import Renderings
from industnerf.geometry.cameras import Cameras

HOOKS: dict[int, Callable[[], None]] = {}
LAST_CALL: dict[str, Any] = {}


@dataclass(frozen=True)
class PosedImages:
    rgb: UInt8[np.ndarray, "n h w 3"]
    cameras: Cameras
    background: Float[np.ndarray, "n 3"] | None
    center: Float[np.ndarray, "3"]
    radius: float


class Callback:
    def on_warning(self, message: str) -> None: ...

    def on_level_start(self, level: str, steps: int) -> None: ...

    def on_step_end(self, loss: torch.Tensor) -> None: ...

    def wants_preview(self) -> bool:
        return False

    def on_preview(
        self, source: UInt8[np.ndarray, "h w 3"], rendered: UInt8[np.ndarray, "h w 3"]
    ) -> None: ...

    def wants_checkpoint(self) -> bool:
        return False

    def on_checkpoint(self, state: dict) -> None: ...


@dataclass(frozen=True)
class ReconstructionResult:
    points: Float32[np.ndarray, "n 3"]
    colors: UInt8[np.ndarray, "n 3"]
    confidence: Float32[np.ndarray, "n"]
    view: Int16[np.ndarray, "n"]
    steps: int
    num_parameters: int
    background: Float[np.ndarray, "n 3"]
    mesh: None = None

    def render_views(self, cameras: Cameras, background: Float[np.ndarray, "n 3"]) -> Renderings:
        """Each image is full of a wall, nearer than what the cameras look at: a solid in walls."""
        shape = (len(cameras), cameras.height, cameras.width)
        distances = np.linalg.norm(cameras.centers - self.points.mean(axis=0), axis=1)
        depth = np.broadcast_to(0.8 * distances[:, None, None], shape).astype(np.float32)
        return Renderings(np.zeros((*shape, 3), np.uint8), depth, np.full(shape, 255, np.uint8))


def run(
    posed_images: PosedImages,
    settings: Any,
    seed: int,
    callback: Callback | None = None,
    resume: dict | None = None,
) -> ReconstructionResult:
    callback = callback or Callback()
    LAST_CALL.update(posed_images=posed_images, settings=settings, seed=seed, resume=resume)
    points = resume["points"] if resume else torch.zeros((0, 3))
    callback.on_level_start("coarse", settings.steps)
    for step in range(len(points), settings.steps):
        HOOKS.get(step, lambda: None)()
        # within the ball, as a part is
        offset = np.random.default_rng([seed, step]).uniform(-0.5, 0.5, (1, 3))
        offset *= posed_images.radius
        points = torch.cat(
            [points, torch.tensor(posed_images.center + offset, dtype=torch.float32)]
        )
        callback.on_step_end(torch.tensor(1.0 / (step + 1)))
        if callback.wants_preview():
            callback.on_preview(posed_images.rgb[0], 255 - posed_images.rgb[0])
        if callback.wants_checkpoint():
            callback.on_checkpoint({"points": points})
    n = len(points)
    return ReconstructionResult(
        points.numpy(),
        np.arange(3 * n, dtype=np.uint8).reshape(n, 3),
        np.linspace(0, 1, n, dtype=np.float32),
        (np.arange(n) % len(posed_images.rgb)).astype(np.int16),
        settings.steps,
        4,
        np.ones((len(posed_images.rgb), 3)),
    )
