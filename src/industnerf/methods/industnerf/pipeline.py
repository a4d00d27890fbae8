"""Sections 3.1 to 3.4 on one part, figure 2 of the paper: from posed images to a point cloud."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Float32, Int16, Int32, UInt8
from torch import Tensor

from industnerf.artifacts.renderings import Renderings
from industnerf.device import device
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import Cameras
from industnerf.learning.weights import load_arrays, torch_seed
from industnerf.methods.industnerf.confidence import ViewConfidence
from industnerf.methods.industnerf.extraction import extract_point_cloud
from industnerf.methods.industnerf.field import Field, SharedModules
from industnerf.methods.industnerf.point_levels import (
    WARM_UP,
    PointLevel,
    grid_spacing,
    initial_grid,
    level_name,
)
from industnerf.methods.industnerf.rerender import Background, render_views
from industnerf.methods.industnerf.scene import PosedImages, make_scene
from industnerf.methods.industnerf.trainer import Trainer
from industnerf.methods.industnerf.variant import Variant
from industnerf.schema import IndustnerfSettings
from industnerf.torch_kernels import use_reproducible_kernels


class Callback:
    """Hooks on the progress of a run, which do nothing; subclass it and override some."""

    def on_warning(self, message: str) -> None:
        """A problem with the images that does not stop the run."""

    def on_level_start(self, level: str, steps: int) -> None:
        """A level of so many steps begins."""

    def on_step_end(self, loss: Float32[Tensor, ""]) -> None:
        """A step is done; to read its loss is to wait for the device."""

    def wants_preview(self) -> bool:
        """Whether `on_preview` is to be called."""
        return False

    def on_preview(
        self, source: UInt8[np.ndarray, "h w 3"], rendered: UInt8[np.ndarray, "h w 3"]
    ) -> None:
        """A source view and its re-rendering."""

    def wants_checkpoint(self) -> bool:
        """Whether `on_checkpoint` is to be called; asked after steps that a run can resume from."""
        return False

    def on_checkpoint(self, state: dict[str, Any]) -> None:
        """`state` is of tensors, numbers and texts, for `run` to resume from."""


@dataclass(frozen=True)
class ReconstructionResult:
    """The cloud in the frame and unit of the cameras, and what it is made from."""

    points: Float32[np.ndarray, "n 3"]
    colors: UInt8[np.ndarray, "n 3"]
    confidence: Float32[np.ndarray, "n"]
    view: Int16[np.ndarray, "n"]
    steps: int
    num_parameters: int
    candidates: Float32[np.ndarray, "m 3"]  # the points that have a density
    candidate_confidence: Float32[np.ndarray, "m"]  # (13)
    losses: list[float]  # of every step
    level_starts: dict[str, int]  # first step of each level
    background: Background  # color behind the part, view by view
    render_views: Callable[[Cameras, Background], Renderings]  # from any cameras
    warnings: tuple[str, ...] = ()  # about the images
    # vertices and faces of the surface, where the method has one of its own
    mesh: Callable[[], tuple[Float[np.ndarray, "v 3"], Int32[np.ndarray, "f 3"]]] | None = None


def run(
    posed: PosedImages,
    settings: IndustnerfSettings,
    seed: int,
    callback: Callback | None = None,
    resume: dict[str, Any] | None = None,
    pretrained: Mapping[str, np.ndarray] | None = None,
    make_variant: type[Variant] = Variant,
) -> ReconstructionResult:
    """Reconstruct one part from its images; `pretrained` are initial weights of E and N.

    Raises ReconstructionFailed if a field becomes empty.  Same seed, same bytes on a CPU.
    """
    use_reproducible_kernels()  # parts are what runs side by side
    callback = callback or Callback()
    reconstructor = Reconstructor(posed, settings, seed, callback, pretrained, make_variant)
    if resume:
        reconstructor.restore(resume)
    while not reconstructor.is_finished:
        reconstructor.train()
        reconstructor.advance_level()
    return reconstructor.result()


class Reconstructor:
    """The state of a run between two steps; `run` takes them all."""

    def __init__(
        self,
        posed: PosedImages,
        settings: IndustnerfSettings,
        seed: int,
        callback: Callback,
        pretrained: Mapping[str, np.ndarray] | None = None,
        make_variant: type[Variant] = Variant,
    ) -> None:
        self._posed, self._callback, self._seed = posed, callback, seed
        self.scene = make_scene(posed, device())
        self.variant = make_variant(self.scene, posed, settings)
        self._settings = settings = self.variant.settings
        for message in self.variant.warnings:
            callback.on_warning(message)
        self._generator = torch.Generator().manual_seed(seed)
        with torch_seed(seed):
            self.field = Field(self.scene, settings).to(self.scene.images.device)
        if pretrained:
            load_arrays(SharedModules(self.field), pretrained)
        self._losses, self.level_starts = [], {}
        self.view_confidence: ViewConfidence | None = None
        self._level = self._first_level = WARM_UP if settings.warm_up.steps else 0
        self.is_finished = False
        spacing = grid_spacing(settings.grid_res, self._level)
        self.trainer = self._make_trainer(
            PointLevel(initial_grid(spacing, self.scene.images.device), spacing)
        )

    def _make_trainer(self, points: PointLevel) -> Trainer:
        """The trainer of this level."""
        points = self.variant.initial_points(points)
        if not len(points.points):
            raise ReconstructionFailed(
                f"no point is left of {level_name(self._level)}: is the part inside the region of "
                "interest, and is the background's color right?"
            )
        return Trainer(
            self.scene,
            self.field,
            points,
            self._level,
            self._settings,
            self._generator,
            self.variant.constraints,
        )

    @property
    def is_last_level(self) -> bool:
        """Whether no level comes after this one."""
        return self._level == len(self._settings.levels) - 1

    def train(self) -> None:
        """Take the remaining steps of this level."""
        name = level_name(self._level)
        self.level_starts.setdefault(name, len(self._losses))
        self._callback.on_level_start(name, self.trainer.num_steps - self.trainer.steps_done)
        while self.trainer.steps_done < self.trainer.num_steps:
            self.record_step(self.trainer.step())
            if self.trainer.is_checkpointable and self._callback.wants_checkpoint():
                self._callback.on_checkpoint(self.state())

    def record_step(self, loss: Float32[Tensor, ""]) -> None:
        """Keep the loss of a step, and call back."""
        self._losses.append(loss)
        self._callback.on_step_end(loss)
        if self._callback.wants_preview():
            self._callback.on_preview(*self._render_preview())

    def advance_level(self) -> None:
        """Compute the confidence of the level's points, and refine them or finish."""
        self.is_finished = self.is_last_level
        self.view_confidence = self.trainer.view_confidence()
        if self.is_finished:
            return
        points = self.variant.refine(self.trainer, self.view_confidence, self._generator)
        self._prune()
        self._level += 1
        self.trainer = self._make_trainer(points)

    def _prune(self) -> None:
        """Prune N once, after the first level."""
        fraction, network = self._settings.network.prune_fraction, self.field.network
        if fraction and network is not None and not network.num_pruned:
            network.prune(fraction)

    def result(self) -> ReconstructionResult:
        """The cloud, of the last level."""
        settings = self._settings
        _, rgb = self.trainer.values()
        points, has_density = self.trainer.points.positions, self.trainer.has_density
        reading = settings.readings.extraction
        cloud = extract_point_cloud(
            points, rgb, self.view_confidence, self._posed, settings, reading, self._seed
        )
        return ReconstructionResult(
            self._to_world(cloud.points),
            (cloud.rgb * 255).round().to(torch.uint8).cpu().numpy(),
            cloud.confidence.cpu().numpy(),
            cloud.view.to(torch.int16).cpu().numpy(),
            len(self._losses),
            self.field.num_parameters(),
            self._to_world(points[has_density]),
            self.view_confidence.confidence[has_density].cpu().numpy(),
            self.losses(),
            self.level_starts,
            self.scene.background.cpu().numpy().astype(float),
            partial(render_views, self.trainer, self._posed),
            self.variant.warnings,
        )

    def _to_world(self, points: Float32[Tensor, "n 3"]) -> Float32[np.ndarray, "n 3"]:
        return self._posed.to_world(points.double().cpu().numpy())

    def losses(self) -> list[float]:
        """Losses of the steps so far."""
        return [loss.item() for loss in self._losses]

    def _render_preview(self) -> tuple[np.ndarray, np.ndarray]:
        view = slice(0, 1)
        cameras, background = self._posed.cameras[view], self.scene.background[view]
        rendering = render_views(self.trainer, self._posed, cameras, background.cpu().numpy())
        return self._posed.rgb[0], rendering.rgb[0]

    def state(self) -> dict[str, Any]:
        """All that the rest of the run depends on, for `restore`."""
        return {
            "level": self._level,
            "losses": self.losses(),
            "level_starts": self.level_starts,
            "generator": self._generator.get_state(),
            "trainer": self.trainer.state(),
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Continue from `state`, whose tensors may be on the CPU."""
        self._level = state["level"]
        self._losses = [torch.tensor(loss) for loss in state["losses"]]
        self.level_starts = state["level_starts"]
        if self._level > self._first_level:
            self._prune()  # its state has the masks
        trainer_state, torch_device = state["trainer"], self.scene.images.device
        points, view_weights = (
            trainer_state["points"].to(torch_device),
            trainer_state["view_weights"],
        )
        view_weights = None if view_weights is None else view_weights.to(torch_device)
        self.trainer = self._make_trainer(
            PointLevel(points, trainer_state["spacing"], view_weights=view_weights)
        )
        self.trainer.restore(trainer_state)
        self._generator.set_state(state["generator"])
