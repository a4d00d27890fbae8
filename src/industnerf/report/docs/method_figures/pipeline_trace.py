"""One part's run of the method, with its intermediate values."""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float, Float32, Int16, UInt8
from scipy.spatial import cKDTree
from torch import Tensor

from industnerf.artifacts.renderings import Renderings
from industnerf.methods.industnerf.confidence import compute_view_confidence
from industnerf.methods.industnerf.pipeline import Callback, ReconstructionResult, Reconstructor
from industnerf.methods.industnerf.point_levels import WARM_UP
from industnerf.methods.industnerf.ray_sampler import RaySampler, footprint
from industnerf.methods.industnerf.rerender import render_views
from industnerf.methods.industnerf.scene import NerfScene, PosedImages, source_target_split
from industnerf.methods.industnerf.trainer import Trainer
from industnerf.report.figures.contact_sheet import best_view
from industnerf.schema import IndustnerfSettings

CONFIDENCE_VIEWS = 3  # views whose own confidences are kept


@dataclass(frozen=True)
class CoarseLevel:
    """The first level as its training leaves it; all of it in the unit frame."""

    points: Float32[Tensor, "m 3"]
    sigma: Float32[Tensor, "m"]
    rgb: Float32[Tensor, "m 3"]
    visibility: Float32[Tensor, "m"]
    inputs: Float32[Tensor, "m i"] | None  # of N: encoding, then pooled features
    features: Float32[Tensor, "c th tw"] | None  # E(I) of the chosen view


@dataclass(frozen=True)
class FineLevel:
    """The last level after training."""

    points: Float32[Tensor, "m 3"]
    values: Float32[Tensor, "m"]  # of the points: signed distances, or densities if beta is 0
    sigma: Float32[Tensor, "m"]
    rgb: Float32[Tensor, "m 3"]
    confidence: Float32[Tensor, "m"]
    view_confidences: dict[int, Float32[Tensor, "m"]]  # view -> its own confidence
    spacing: float
    beta: float  # of the SDF density


@dataclass(frozen=True)
class PipelineTrace:
    """What the figures show, on the CPU; most of them are drawn from the source view `view`."""

    part_id: str
    images: PosedImages
    settings: IndustnerfSettings
    view: int
    coarse: CoarseLevel
    kept_points: Float32[
        Tensor, "k 3"
    ]  # of the first level in the second; none if there is no second
    sampled_points: Float32[Tensor, "d 3"]  # new in the second
    fine: FineLevel
    rendered: Renderings  # of `view`
    cloud_mm: Float32[np.ndarray, "n 3"]
    colors: UInt8[np.ndarray, "n 3"]
    confidence: Float32[np.ndarray, "n"]
    argmax_view: Int16[np.ndarray, "n"]  # the view with the highest confidence of each point

    def to_mm(self, points: Float32[Tensor, "m 3"]) -> Float[np.ndarray, "m 3"]:
        """Points of the unit frame in the cameras' frame."""
        return points.double().numpy() * self.images.radius + self.images.center


def trace_pipeline(
    part_id: str, images: PosedImages, settings: IndustnerfSettings, seed: int
) -> PipelineTrace:
    """Run the method and keep intermediate values.  Raises ReconstructionFailed as `run` does."""
    reconstructor = Reconstructor(images, settings, seed, Callback())
    view = best_view(images.cameras)
    reconstructor.train()
    if reconstructor.trainer.level == WARM_UP:
        reconstructor.advance_level()
        reconstructor.train()
    first = reconstructor.trainer
    with torch.no_grad():
        inputs, features = _network_inputs(first, len(reconstructor.scene), view)
    points, sigma, (_, rgb) = first.points.positions, first.density(), first.values()
    reconstructor.advance_level()
    arrays = points, sigma, rgb, reconstructor.view_confidence.confidence, inputs, features
    coarse = CoarseLevel(*(x if x is None else x.cpu() for x in arrays))
    second = points[:0] if reconstructor.is_finished else reconstructor.trainer.points.positions
    is_new = _is_new(second, points)
    kept_points, sampled_points = second[~is_new].cpu(), second[is_new].cpu()
    while not reconstructor.is_finished:
        reconstructor.train()
        reconstructor.advance_level()
    return _build_trace(
        part_id, images, settings, view, coarse, kept_points, sampled_points, reconstructor
    )


def _network_inputs(
    training: Trainer, views: int, view: int
) -> tuple[Float32[Tensor, "m i"] | None, Float32[Tensor, "c th tw"] | None]:
    """The network inputs of the points and the feature map of the view; None if there is none."""
    sources = training.field.source_features
    if sources is None:
        return None, None
    source_views = range(views)[source_target_split(training.settings.readings.target_views).source]
    if training.settings.readings.encoder == "none" or view not in source_views:
        return sources(), None
    return sources(), next(sources.encode_views(torch.tensor([source_views.index(view)])))


def _is_new(points: Float32[Tensor, "n 3"], old_points: Float32[Tensor, "m 3"]) -> Tensor:
    """Which of `points` are not among `old_points`."""
    distances, _ = cKDTree(old_points.cpu().numpy()).query(points.cpu().numpy())
    return torch.from_numpy(distances > 0).to(points.device)


def _build_trace(
    part_id: str,
    images: PosedImages,
    settings: IndustnerfSettings,
    view: int,
    coarse: CoarseLevel,
    kept_points: Float32[Tensor, "k 3"],
    sampled_points: Float32[Tensor, "d 3"],
    reconstructor: Reconstructor,
) -> PipelineTrace:
    """The trace of a finished run."""
    result: ReconstructionResult = reconstructor.result()
    level, background = reconstructor.trainer, result.background[view : view + 1]
    sigma, (values, rgb), points = level.density(), level.values(), level.points.positions
    view_confidences = {
        v: single_view_confidence(level, reconstructor.scene, v).cpu()
        for v in confidence_views(len(reconstructor.scene), view)
    }
    arrays = points, values, sigma, rgb, reconstructor.view_confidence.confidence
    fine = FineLevel(
        *(x.cpu() for x in arrays),
        view_confidences,
        level.spacing,
        level.fine_renderer(level.settings.beta.render).beta,
    )
    rendered = render_views(level, images, images.cameras[view : view + 1], background)
    cloud = result.points, result.colors, result.confidence, result.view
    return PipelineTrace(
        part_id, images, settings, view, coarse, kept_points, sampled_points, fine, rendered, *cloud
    )


def confidence_views(num_views: int, first: int) -> list[int]:
    """`CONFIDENCE_VIEWS` views, or all if there are fewer, spread over the list from `first` on."""
    count = min(CONFIDENCE_VIEWS, num_views)
    return [(first + i * num_views // count) % num_views for i in range(count)]


def single_view_confidence(training: Trainer, scene: NerfScene, view: int) -> Float32[Tensor, "m"]:
    """Eq. (13) of one view alone; the `contrast` of reading R8 is that of this view."""
    cameras, (values, rgb) = scene[view : view + 1], training.values()
    support_radius, points = training.points.support_radius, training.points.positions
    max_px, readings = training.settings.surface_px, training.settings.readings
    visible_pixels = footprint(
        points[training.density() > 0], support_radius, cameras.cameras, max_px
    )
    pixels = RaySampler(cameras, visible_pixels)
    renderer = training.fine_renderer(training.settings.beta.render)
    return compute_view_confidence(cameras, pixels, renderer, values, rgb, readings).confidence
