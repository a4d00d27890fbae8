"""What came of a run: how far from a known solid it is, its bytes, and what was told on the way."""

import copy
from typing import Any

import numpy as np
from scipy.spatial import cKDTree
from torch import Tensor

from industnerf.methods.industnerf import pipeline
from industnerf.methods.industnerf.pipeline import Callback, ReconstructionResult, Reconstructor
from industnerf.methods.industnerf.scene import PosedImages
from industnerf.methods.industnerf.variant import Variant
from industnerf.methods.industnerf_plus.pipeline import PlusVariant
from industnerf.schema import IndustnerfPlusSettings, IndustnerfSettings
from tests.methods.industnerf.synthetic_scenes import CENTER, Solid, ball, box, texture

SOLIDS = {"ball": ball(18.0), "box": box((16.0, 11.0, 8.0))}


def variant_of(config: IndustnerfSettings) -> type[Variant]:
    """The variant of the method that has these settings."""
    return PlusVariant if isinstance(config, IndustnerfPlusSettings) else Variant


def run(
    images: PosedImages, config: IndustnerfSettings, seed: int, *args: Any, **options: Any
) -> ReconstructionResult:
    """`pipeline.run` of the method that has these settings."""
    return pipeline.run(images, config, seed, *args, **options, make_variant=variant_of(config))


def make_reconstructor(
    images: PosedImages, config: IndustnerfSettings, callback: Callback
) -> Reconstructor:
    """A run of the method that has these settings, before its first step."""
    return Reconstructor(images, config, 1, callback, make_variant=variant_of(config))


def sample_surface(solid: Solid, count: int = 2000) -> np.ndarray:
    """Points all over it."""
    directions = np.random.default_rng(0).normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions * (100 - solid.hit_distance(100 * directions, -directions))[:, None]


def errors(
    solid: Solid, result: ReconstructionResult, within: float = 4.0
) -> tuple[float, float, float]:
    """Mean distance of the points from the surface, mm; the share of the surface that has one
    `within` so many mm; the mean error of the colors."""
    points = result.points - CENTER
    is_covered = cKDTree(points).query(sample_surface(solid))[0] < within
    color_error = np.abs(result.colors / 255 - texture(points)).mean()
    return np.abs(solid.signed_distance(points)).mean(), is_covered.mean(), color_error


def result_bytes(result: ReconstructionResult) -> bytes:
    fields = (result.points, result.colors, result.confidence, result.view)
    return b"".join(values.tobytes() for values in fields) + str(result.losses).encode()


class RecordingCallback(Callback):
    """Remembers all that it is told, and asks for everything."""

    def __init__(self) -> None:
        self.started_levels: list[tuple[str, int]] = []
        self.losses: list[float] = []
        self.states: list[dict[str, Any]] = []
        self.previews: list[tuple[np.ndarray, np.ndarray]] = []

    def on_level_start(self, level: str, steps: int) -> None:
        self.started_levels.append((level, steps))

    def on_step_end(self, loss: Tensor) -> None:
        self.losses.append(loss.item())

    def wants_preview(self) -> bool:
        return True

    def on_preview(self, source: np.ndarray, rendered: np.ndarray) -> None:
        self.previews.append((source, rendered))

    def wants_checkpoint(self) -> bool:
        return True

    def on_checkpoint(self, state: dict[str, Any]) -> None:
        self.states.append(copy.deepcopy(state))
