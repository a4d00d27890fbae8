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
from industnerf.learning.weights import load_arrays, seeded
from industnerf.methods.industnerf.carving import Silhouettes
from industnerf.methods.industnerf.extraction import final_cloud
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.finer import as_fine_as_fits, margin
from industnerf.methods.industnerf.levels import WARM_UP, Layer, grid, name_of, spacing_of
from industnerf.methods.industnerf.pair import Pair
from industnerf.methods.industnerf.photohull import PhotoHull
from industnerf.methods.industnerf.recolour import recolour
from industnerf.methods.industnerf.refine import refined
from industnerf.methods.industnerf.rerender import rerender
from industnerf.methods.industnerf.scene import Posed, eyes, scene_of
from industnerf.methods.industnerf.training import Training
from industnerf.methods.industnerf.witnesses import Testimony
from industnerf.schema import IndustnerfSettings

Background = Float[np.ndarray, "views 3"]


class Watch:
    """Told how the work goes on; does nothing with it.  Subclass it, and override what you want."""

    def remark(self, text: str) -> None:
        """Something about the images that their owner should know."""

    def begin(self, level: str, steps: int) -> None:
        """`steps` steps follow."""

    def step(self, loss: Float32[Tensor, ""]) -> None:
        """One of them is done; to read its loss is to wait for the device."""

    def wants_preview(self) -> bool:
        """Whether `preview` is to be called."""
        return False

    def preview(
        self, source: UInt8[np.ndarray, "h w 3"], rendered: UInt8[np.ndarray, "h w 3"]
    ) -> None:
        """A source view and its re-rendering."""

    def wants_checkpoint(self) -> bool:
        """Whether `checkpoint` is to be called; asked after steps that a run can go on from."""
        return False

    def checkpoint(self, state: dict[str, Any]) -> None:
        """Tensors, numbers and texts that `run` can resume from."""


@dataclass(frozen=True)
class Outcome:
    """The cloud in the frame and unit of the cameras, and how it came about."""

    points: Float32[np.ndarray, "n 3"]
    colours: UInt8[np.ndarray, "n 3"]
    confidence: Float32[np.ndarray, "n"]
    view: Int16[np.ndarray, "n"]
    steps: int
    parameters: int
    candidates: Float32[np.ndarray, "m 3"]  # every point with a density, as the views were asked
    certainty: Float32[np.ndarray, "m"]  # their confidence
    losses: list[float]  # of every step
    first_steps: dict[str, int]  # of every level, and of the colours alone
    background: Background  # behind the part, view by view
    pictures: Callable[[Cameras, Background], Renderings]  # the field from other cameras
    remarks: tuple[str, ...] = ()  # on the images


def run(
    posed: Posed,
    settings: IndustnerfSettings,
    seed: int,
    watch: Watch | None = None,
    resume: dict[str, Any] | None = None,
    learned: Mapping[str, np.ndarray] | None = None,
) -> Outcome:
    """Reconstruct one part from its images; `learned` are the weights that E and N start from.

    Raises ReconstructionFailed if a field becomes empty.  Same seed, same bytes on a CPU.
    """
    torch.set_num_threads(1)  # parts are what runs side by side
    work = Work(posed, settings, seed, watch or Watch(), learned)
    if resume:
        work.restore(resume)
    while not work.finished:
        work.train()
        work.listen()
    return work.outcome()


class Work:
    """A run between two of its steps; `run` takes them all."""

    def __init__(
        self,
        posed: Posed,
        settings: IndustnerfSettings,
        seed: int,
        watch: Watch,
        learned: Mapping[str, np.ndarray] | None = None,
    ) -> None:
        self._posed, self._watch, self._seed = posed, watch, seed
        self.scene = scene_of(posed, device())
        self._silhouettes = None
        if settings.carve:
            self._silhouettes = Silhouettes(self.scene, settings.tolerance)
            settings = as_fine_as_fits(settings, self._silhouettes)
        self._settings = settings
        self._photo_hull, self._remarks = None, ()
        if settings.relief.start.use:
            outlines = self._silhouettes.outlines()
            self._photo_hull = PhotoHull(posed, outlines, settings.relief.start)
            self._remarks = self._photo_hull.remarks
        for text in self._remarks:
            watch.remark(text)
        self._generator = torch.Generator().manual_seed(seed)
        with seeded(seed):
            self._field = Field(self.scene, settings).to(self.scene.images.device)
        if learned:
            load_arrays(Pair(self._field), learned)
        self._losses, self._first_steps = [], {}
        self.told: Testimony | None = None
        self._level = self._first = WARM_UP if settings.warm_up.steps else 0
        self.finished = False
        spacing = spacing_of(settings.grid_res, self._level)
        self.training = self._start(Layer(grid(spacing, self.scene.images.device), spacing))

    def _start(self, layer: Layer) -> Training:
        """The training of this level, of the points that are not carved away."""
        if self._silhouettes:
            slack = margin(self._settings) * layer.spacing
            layer = layer.only(self._silhouettes.may_hold(layer.points, slack))
        if not len(layer.points):
            raise ReconstructionFailed(
                f"no point is left of {name_of(self._level)}: is the part inside the region of "
                "interest, and is the background's colour right?"
            )
        return Training(
            self.scene,
            self._field,
            layer,
            self._level,
            self._settings,
            self._generator,
            self._silhouettes,
            self._photo_hull,
        )

    def train(self) -> None:
        """Take the steps of this level that are left."""
        name = name_of(self._level)
        self._first_steps.setdefault(name, len(self._losses))
        self._watch.begin(name, self.training.steps - self.training.taken)
        while self.training.taken < self.training.steps:
            self._took(self.training.step())
            if self.training.can_stop and self._watch.wants_checkpoint():
                self._watch.checkpoint(self.state())

    def _recolour(self) -> None:
        """Short enough to be taken anew by who goes on from a checkpoint."""
        self._first_steps["colours"] = len(self._losses)
        self._watch.begin("colours", self._settings.recolour.steps)
        for loss in recolour(self.training):
            self._took(loss)

    def _took(self, loss: Float32[Tensor, ""]) -> None:
        """A step is done."""
        self._losses.append(loss)
        self._watch.step(loss)
        if self._watch.wants_preview():
            self._watch.preview(*self._preview())

    def listen(self) -> None:
        """Hear what the views say of the level's points; go on to the next level, or finish.

        To finish is to learn the colours once more, where `recolour` asks for it.
        """
        self.finished = self._level == len(self._settings.levels) - 1
        if self.finished or not self.training.relief:  # which is refined without a word of theirs
            self.told = self.training.testimony()
        if self.finished and self._settings.recolour.steps:
            self._recolour()
        if not self.finished:
            layer = refined(self.training, self.told, self._generator)
            self._prune()
            self._level += 1
            self.training = self._start(layer)

    def _prune(self) -> None:
        """Once, when the first points have been learned from."""
        share, network = self._settings.network.pruned, self._field.network
        if share and network is not None and not network.pruned:
            network.prune(share)

    def outcome(self) -> Outcome:
        """The cloud, of the last level."""
        ways = self._settings
        _, rgb = self.training.values()
        points, dense = self.training.points.positions, self.training.filled
        reading = ways.readings.cloud
        cloud = final_cloud(points, rgb, self.told, self._posed, ways, reading, self._seed)
        return Outcome(
            self._in_world(cloud.points),
            (cloud.rgb * 255).round().to(torch.uint8).cpu().numpy(),
            cloud.confidence.cpu().numpy(),
            cloud.view.to(torch.int16).cpu().numpy(),
            len(self._losses),
            self._field.numbers(),
            self._in_world(points[dense]),
            self.told.confidence[dense].cpu().numpy(),
            self._read(),
            self._first_steps,
            self.scene.background.cpu().numpy().astype(float),
            partial(pictures, self.training, self._posed),
            self._remarks,
        )

    def _in_world(self, points: Float32[Tensor, "n 3"]) -> Float32[np.ndarray, "n 3"]:
        world = points.double().cpu().numpy() * self._posed.radius + self._posed.centre
        return world.astype(np.float32)

    def _read(self) -> list[float]:
        """The losses so far."""
        return [loss.item() for loss in self._losses]

    def _preview(self) -> tuple[np.ndarray, np.ndarray]:
        view = slice(0, 1)
        cameras, behind = self._posed.cameras[view], self.scene.background[view]
        seen = pictures(self.training, self._posed, cameras, behind.cpu().numpy())
        return self._posed.rgb[0], seen.rgb[0]

    def state(self) -> dict[str, Any]:
        """All that the rest of the run depends on."""
        return {
            "level": self._level,
            "losses": self._read(),
            "first_steps": self._first_steps,
            "generator": self._generator.get_state(),
            "training": self.training.state(),
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from `state`, whose tensors may lie on the CPU."""
        self._level = state["level"]
        self._losses = [torch.tensor(loss) for loss in state["losses"]]
        self._first_steps = state["first_steps"]
        if self._level > self._first:
            self._prune()  # which weights, its state says
        trained, where = state["training"], self.scene.images.device
        points, trust = trained["points"].to(where), trained["trust"]
        trust = None if trust is None else trust.to(where)
        self.training = self._start(Layer(points, trained["spacing"], trust=trust))
        self.training.restore(trained)
        self._generator.set_state(state["generator"])


def pictures(
    training: Training, posed: Posed, cameras: Cameras, background: Background
) -> Renderings:
    """The field of `training` from `cameras`, before `background`, depth in the cameras' unit.

    Colour and opacity as soft as it was learned, but for space that is empty for the hard surface,
    which is skipped as it was when colours were learned.  Depth is that of its surface, as hard as
    this is looked for, and of the soft one in pixels that pass the hard one by.
    """
    where = training.points.positions.device
    behind = torch.tensor(background, dtype=torch.float32, device=where)
    looking = eyes(cameras, posed.centre, posed.radius, where)
    renderer = training.finely(training.softness())
    return rerender(looking, behind, renderer, *training.values(), posed.radius)
