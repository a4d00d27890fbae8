"""The whole method on one part: figure 2 of the paper, from posed images to a cloud."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Float32, Int16, UInt8
from torch import Tensor

from industnerf.artifacts.renderings import Renderings
from industnerf.device import device
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import Cameras
from industnerf.learning.weights import load_arrays, torch_seed
from industnerf.methods.industnerf.extraction import extract_point_cloud
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.point_levels import (
    WARM_UP,
    PointLevel,
    grid_spacing,
    initial_grid,
    level_name,
)
from industnerf.methods.industnerf.refine import refine_points
from industnerf.methods.industnerf.rerender import rerender
from industnerf.methods.industnerf.scene import PosedImages, make_scene, torch_cameras
from industnerf.methods.industnerf.shared_modules import SharedModules
from industnerf.methods.industnerf.trainer import Trainer
from industnerf.methods.industnerf.view_confidence import ViewConfidence
from industnerf.methods.industnerf_plus.adaptive_resolution import adapt_resolution, hull_margin
from industnerf.methods.industnerf_plus.color_refinement import refine_colors
from industnerf.methods.industnerf_plus.photo_hull import PhotoHull
from industnerf.methods.industnerf_plus.silhouette_carving import Silhouettes
from industnerf.schema import IndustnerfSettings

Background = Float[np.ndarray, "views 3"]


class Callback:
    """Told how the work goes on; does nothing with it.  Subclass it, and override what you want."""

    def on_warning(self, message: str) -> None:
        """Something about the images that their owner should know."""

    def on_level_start(self, level: str, steps: int) -> None:
        """`steps` steps follow."""

    def on_step_end(self, loss: Float32[Tensor, ""]) -> None:
        """One of them is done; to read its loss is to wait for the device."""

    def wants_preview(self) -> bool:
        """Whether `preview` is to be called."""
        return False

    def on_preview(
        self, source: UInt8[np.ndarray, "h w 3"], rendered: UInt8[np.ndarray, "h w 3"]
    ) -> None:
        """A source view and its re-rendering."""

    def wants_checkpoint(self) -> bool:
        """Whether `checkpoint` is to be called; asked after steps that a run can go on from."""
        return False

    def on_checkpoint(self, state: dict[str, Any]) -> None:
        """Tensors, numbers and texts that `run` can resume from."""


@dataclass(frozen=True)
class ReconstructionResult:
    """The cloud in the frame and unit of the cameras, and how it came about."""

    points: Float32[np.ndarray, "n 3"]
    colors: UInt8[np.ndarray, "n 3"]
    confidence: Float32[np.ndarray, "n"]
    view: Int16[np.ndarray, "n"]
    steps: int
    num_parameters: int
    candidates: Float32[np.ndarray, "m 3"]  # every point with a density, as the views were asked
    candidate_confidence: Float32[np.ndarray, "m"]  # their confidence
    losses: list[float]  # of every step
    level_starts: dict[str, int]  # of every level, and of the colors alone
    background: Background  # behind the part, view by view
    render_views: Callable[[Cameras, Background], Renderings]  # the field from other cameras
    warnings: tuple[str, ...] = ()  # on the images


def run(
    posed: PosedImages,
    settings: IndustnerfSettings,
    seed: int,
    callback: Callback | None = None,
    resume: dict[str, Any] | None = None,
    pretrained: Mapping[str, np.ndarray] | None = None,
) -> ReconstructionResult:
    """Reconstruct one part from its images; `learned` are the weights that E and N start from.

    Raises ReconstructionFailed if a field becomes empty.  Same seed, same bytes on a CPU.
    """
    torch.set_num_threads(1)  # parts are what runs side by side
    reconstructor = Reconstructor(posed, settings, seed, callback or Callback(), pretrained)
    if resume:
        reconstructor.restore(resume)
    while not reconstructor.is_finished:
        reconstructor.train()
        reconstructor.advance_level()
    return reconstructor.result()


class Reconstructor:
    """A run between two of its steps; `run` takes them all."""

    def __init__(
        self,
        posed: PosedImages,
        settings: IndustnerfSettings,
        seed: int,
        callback: Callback,
        pretrained: Mapping[str, np.ndarray] | None = None,
    ) -> None:
        self._posed, self._callback, self._seed = posed, callback, seed
        self.scene = make_scene(posed, device())
        self._silhouettes = None
        if settings.silhouette_carving:
            self._silhouettes = Silhouettes(self.scene, settings.background_tolerance)
            settings = adapt_resolution(settings, self._silhouettes)
        self._settings = settings
        self._photo_hull, self._warnings = None, ()
        if settings.sdf.init.enabled:
            outlines = self._silhouettes.outlines()
            self._photo_hull = PhotoHull(posed, outlines, settings.sdf.init)
            self._warnings = self._photo_hull.warnings
        for message in self._warnings:
            callback.on_warning(message)
        self._generator = torch.Generator().manual_seed(seed)
        with torch_seed(seed):
            self._field = Field(self.scene, settings).to(self.scene.images.device)
        if pretrained:
            load_arrays(SharedModules(self._field), pretrained)
        self._losses, self._level_starts = [], {}
        self.view_confidence: ViewConfidence | None = None
        self._level = self._first_level = WARM_UP if settings.warm_up.steps else 0
        self.is_finished = False
        spacing = grid_spacing(settings.grid_res, self._level)
        self.trainer = self._make_trainer(
            PointLevel(initial_grid(spacing, self.scene.images.device), spacing)
        )

    def _make_trainer(self, points: PointLevel) -> Trainer:
        """The training of this level, of the points that are not carved away."""
        if self._silhouettes:
            hull_margin_length = hull_margin(self._settings) * points.spacing
            points = points.select(self._silhouettes.inside_hull(points.points, hull_margin_length))
        if not len(points.points):
            raise ReconstructionFailed(
                f"no point is left of {level_name(self._level)}: is the part inside the region of "
                "interest, and is the background's color right?"
            )
        return Trainer(
            self.scene,
            self._field,
            points,
            self._level,
            self._settings,
            self._generator,
            self._silhouettes,
            self._photo_hull,
        )

    def train(self) -> None:
        """Take the steps of this level that are left."""
        name = level_name(self._level)
        self._level_starts.setdefault(name, len(self._losses))
        self._callback.on_level_start(name, self.trainer.num_steps - self.trainer.steps_done)
        while self.trainer.steps_done < self.trainer.num_steps:
            self._record_step(self.trainer.step())
            if self.trainer.is_checkpointable and self._callback.wants_checkpoint():
                self._callback.on_checkpoint(self.state())

    def _refine_colors(self) -> None:
        """Short enough to be taken anew by who goes on from a checkpoint."""
        self._level_starts["colors"] = len(self._losses)
        self._callback.on_level_start("colors", self._settings.color_refinement.steps)
        for loss in refine_colors(self.trainer):
            self._record_step(loss)

    def _record_step(self, loss: Float32[Tensor, ""]) -> None:
        """A step is done."""
        self._losses.append(loss)
        self._callback.on_step_end(loss)
        if self._callback.wants_preview():
            self._callback.on_preview(*self._render_preview())

    def advance_level(self) -> None:
        """Hear what the views say of the level's points; go on to the next level, or finish.

        To finish is to learn the colors once more, where `recolor` asks for it.
        """
        self.is_finished = self._level == len(self._settings.levels) - 1
        if (
            self.is_finished or not self.trainer.sdf_constraints
        ):  # which is refined without a word of theirs
            self.view_confidence = self.trainer.view_confidence()
        if self.is_finished and self._settings.color_refinement.steps:
            self._refine_colors()
        if not self.is_finished:
            next_points = refine_points(self.trainer, self.view_confidence, self._generator)
            self._prune()
            self._level += 1
            self.trainer = self._make_trainer(next_points)

    def _prune(self) -> None:
        """Once, when the first points have been learned from."""
        fraction, network = self._settings.network.prune_fraction, self._field.network
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
            self._field.num_parameters(),
            self._to_world(points[has_density]),
            self.view_confidence.confidence[has_density].cpu().numpy(),
            self._loss_values(),
            self._level_starts,
            self.scene.background.cpu().numpy().astype(float),
            partial(render_views, self.trainer, self._posed),
            self._warnings,
        )

    def _to_world(self, points: Float32[Tensor, "n 3"]) -> Float32[np.ndarray, "n 3"]:
        world = points.double().cpu().numpy() * self._posed.radius + self._posed.center
        return world.astype(np.float32)

    def _loss_values(self) -> list[float]:
        """The losses so far."""
        return [loss.item() for loss in self._losses]

    def _render_preview(self) -> tuple[np.ndarray, np.ndarray]:
        view = slice(0, 1)
        cameras, background = self._posed.cameras[view], self.scene.background[view]
        rendering = render_views(self.trainer, self._posed, cameras, background.cpu().numpy())
        return self._posed.rgb[0], rendering.rgb[0]

    def state(self) -> dict[str, Any]:
        """All that the rest of the run depends on."""
        return {
            "level": self._level,
            "losses": self._loss_values(),
            "first_steps": self._level_starts,
            "generator": self._generator.get_state(),
            "training": self.trainer.state(),
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from `state`, whose tensors may lie on the CPU."""
        self._level = state["level"]
        self._losses = [torch.tensor(loss) for loss in state["losses"]]
        self._level_starts = state["first_steps"]
        if self._level > self._first_level:
            self._prune()  # which weights, its state says
        trainer_state, torch_device = state["training"], self.scene.images.device
        points, view_weights = trainer_state["points"].to(torch_device), trainer_state["trust"]
        view_weights = None if view_weights is None else view_weights.to(torch_device)
        self.trainer = self._make_trainer(
            PointLevel(points, trainer_state["spacing"], view_weights=view_weights)
        )
        self.trainer.restore(trainer_state)
        self._generator.set_state(state["generator"])


def render_views(
    trainer: Trainer, posed: PosedImages, cameras: Cameras, background: Background
) -> Renderings:
    """The field of `training` from `cameras`, before `background`, depth in the cameras' unit.

    Color and opacity as soft as it was learned, but for space that is empty for the hard surface,
    which is skipped as it was when colors were learned.  Depth is that of its surface, as hard as
    this is looked for, and of the soft one in pixels that pass the hard one by.
    """
    torch_device = trainer.points.positions.device
    background_colors = torch.tensor(background, dtype=torch.float32, device=torch_device)
    render_cameras = torch_cameras(cameras, posed.center, posed.radius, torch_device)
    renderer = trainer.fine_renderer(trainer.beta())
    return rerender(render_cameras, background_colors, renderer, *trainer.values(), posed.radius)
