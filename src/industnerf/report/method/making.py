"""One part's run of the method, with what it passed through on the way."""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float, Float32, Int16, UInt8
from scipy.spatial import cKDTree
from torch import Tensor

from industnerf.artifacts.renderings import Renderings
from industnerf.methods.industnerf.levels import WARM_UP
from industnerf.methods.industnerf.pixels import Pixels, footprint
from industnerf.methods.industnerf.roles import view_roles
from industnerf.methods.industnerf.run import Outcome, Watch, Work, pictures
from industnerf.methods.industnerf.scene import Posed, Scene
from industnerf.methods.industnerf.training import Training
from industnerf.methods.industnerf.witnesses import testimony
from industnerf.report.pictures import nicest_view
from industnerf.schema import IndustnerfSettings

WITNESSES = 3  # views whose own confidences are kept


@dataclass(frozen=True)
class Coarse:
    """The first level as its training leaves it; all of it in the unit frame."""

    points: Float32[Tensor, "m 3"]
    sigma: Float32[Tensor, "m"]
    rgb: Float32[Tensor, "m 3"]
    visibility: Float32[Tensor, "m"]
    inputs: Float32[Tensor, "m i"] | None  # of N: encoding, then pooled features
    features: Float32[Tensor, "c th tw"] | None  # E(I) of the chosen view


@dataclass(frozen=True)
class Fine:
    """The last level when all is done."""

    points: Float32[Tensor, "m 3"]
    values: Float32[Tensor, "m"]  # that the points hold: distances, or densities if beta is 0
    sigma: Float32[Tensor, "m"]
    rgb: Float32[Tensor, "m 3"]
    confidence: Float32[Tensor, "m"]
    witnesses: dict[int, Float32[Tensor, "m"]]  # view -> what it alone says
    spacing: float
    beta: float  # softness of the surface


@dataclass(frozen=True)
class Making:
    """What the plates show, on the CPU; most of them are drawn from the source view `view`."""

    part_id: str
    posed: Posed
    settings: IndustnerfSettings
    view: int
    coarse: Coarse
    kept: Float32[Tensor, "k 3"]  # of the first level in the second; none if there is no second
    drawn: Float32[Tensor, "d 3"]  # new in the second
    fine: Fine
    rendered: Renderings  # of `view`
    cloud_mm: Float32[np.ndarray, "n 3"]
    colours: UInt8[np.ndarray, "n 3"]
    confidence: Float32[np.ndarray, "n"]
    sure: Int16[np.ndarray, "n"]  # the view that is surest of each point

    def in_mm(self, points: Float32[Tensor, "m 3"]) -> Float[np.ndarray, "m 3"]:
        """Points of the unit frame in the cameras' frame."""
        return points.double().numpy() * self.posed.radius + self.posed.centre


def make(part_id: str, posed: Posed, settings: IndustnerfSettings, seed: int) -> Making:
    """Run the method, stopping to look.  Raises ReconstructionFailed as `run` does."""
    work = Work(posed, settings, seed, Watch())
    view = nicest_view(posed.cameras)
    work.train()
    if work.training.level == WARM_UP:
        work.listen()
        work.train()
    first = work.training
    with torch.no_grad():
        inputs, features = _told(first, len(work.scene), view)
    points, sigma, (_, rgb) = first.points.positions, first.density(), first.values()
    work.listen()
    told = points, sigma, rgb, work.told.confidence, inputs, features
    coarse = Coarse(*(x if x is None else x.cpu() for x in told))
    second = points[:0] if work.finished else work.training.points.positions
    new = _is_new(second, points)
    kept, drawn = second[~new].cpu(), second[new].cpu()
    while not work.finished:
        work.train()
        work.listen()
    return _made(part_id, posed, settings, view, coarse, kept, drawn, work)


def _told(
    training: Training, views: int, view: int
) -> tuple[Float32[Tensor, "m i"] | None, Float32[Tensor, "c th tw"] | None]:
    """What N is told of the points, and the feature map of the view; None where there is none."""
    sources = training.field.sources
    if sources is None:
        return None, None
    telling = range(views)[view_roles(training.ways.readings.signal).telling]
    if training.ways.readings.encoder == "none" or view not in telling:
        return sources(), None
    return sources(), next(sources.encoded(torch.tensor([telling.index(view)])))


def _is_new(points: Float32[Tensor, "n 3"], old: Float32[Tensor, "m 3"]) -> Tensor:
    """Which points are none of the old ones."""
    away, _ = cKDTree(old.cpu().numpy()).query(points.cpu().numpy())
    return torch.from_numpy(away > 0).to(points.device)


def _made(
    part_id: str,
    posed: Posed,
    settings: IndustnerfSettings,
    view: int,
    coarse: Coarse,
    kept: Float32[Tensor, "k 3"],
    drawn: Float32[Tensor, "d 3"],
    work: Work,
) -> Making:
    """All of it, from a run that has finished."""
    out: Outcome = work.outcome()
    last, behind = work.training, out.background[view : view + 1]
    sigma, (values, rgb), points = last.density(), last.values(), last.points.positions
    some = {v: alone(last, work.scene, v).cpu() for v in witnesses_of(len(work.scene), view)}
    all_of_them = points, values, sigma, rgb, work.told.confidence
    fine = Fine(
        *(x.cpu() for x in all_of_them),
        some,
        last.spacing,
        last.finely(last.ways.softness.shown).beta,
    )
    rendered = pictures(last, posed, posed.cameras[view : view + 1], behind)
    cloud = out.points, out.colours, out.confidence, out.view
    return Making(part_id, posed, settings, view, coarse, kept, drawn, fine, rendered, *cloud)


def witnesses_of(views: int, first: int) -> list[int]:
    """`WITNESSES` views, or all where there are fewer, spread over the list from `first` on."""
    count = min(WITNESSES, views)
    return [(first + i * views // count) % views for i in range(count)]


def alone(training: Training, scene: Scene, view: int) -> Float32[Tensor, "m"]:
    """(13) as one view has it.  R8's `contrast` is then that of this view."""
    one, (values, rgb) = scene[view : view + 1], training.values()
    reach, points = training.points.reach, training.points.positions
    longest, readings = training.ways.surface_px, training.ways.readings
    shown = footprint(points[training.density() > 0], reach, one.eyes, longest)
    pixels = Pixels(one, shown)
    renderer = training.finely(training.ways.softness.shown)
    return testimony(one, pixels, renderer, values, rgb, readings).confidence
