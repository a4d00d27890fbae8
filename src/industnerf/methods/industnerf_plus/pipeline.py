"""The additions of `industnerf_plus`, put together as a variant of the paper's method."""

from collections.abc import Iterator
from functools import partial

import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.methods.industnerf import pipeline
from industnerf.methods.industnerf.confidence import ViewConfidence
from industnerf.methods.industnerf.optimizer import Constraints
from industnerf.methods.industnerf.point_levels import PointLevel, grid_spacing
from industnerf.methods.industnerf.scene import NerfScene, PosedImages
from industnerf.methods.industnerf.trainer import Trainer
from industnerf.methods.industnerf.variant import Variant
from industnerf.methods.industnerf_plus.adaptive_resolution import adapt_resolution, hull_margin
from industnerf.methods.industnerf_plus.color_refinement import refine_colors
from industnerf.methods.industnerf_plus.narrow_band import subdivide_narrow_band
from industnerf.methods.industnerf_plus.photo_hull import PhotoHull
from industnerf.methods.industnerf_plus.sdf_constraints import SdfConstraints, grid_neighbors
from industnerf.methods.industnerf_plus.silhouette_carving import Silhouettes
from industnerf.rendering.points import PointGrid
from industnerf.schema import IndustnerfPlusSettings


class PlusVariant(Variant):
    """Each addition is used if the settings enable it."""

    settings: IndustnerfPlusSettings

    def __init__(
        self, scene: NerfScene, posed: PosedImages, settings: IndustnerfPlusSettings
    ) -> None:
        super().__init__(scene, posed, settings)
        self._silhouettes: Silhouettes | None = None
        self._photo_hull: PhotoHull | None = None
        if settings.silhouette_carving:
            self._silhouettes = Silhouettes(scene, settings.background_tolerance)
            self.settings = adapt_resolution(settings, self._silhouettes)
        if settings.sdf.init.enabled:
            outlines = self._silhouettes.outlines()
            self._photo_hull = PhotoHull(posed, outlines, settings.sdf.init)
            self.warnings = self._photo_hull.warnings
        self.refines_by_confidence = not settings.sdf.enabled

    def initial_points(self, points: PointLevel) -> PointLevel:
        """The points in the visual hull, and somewhat beyond it."""
        if self._silhouettes is None:
            return points
        margin = hull_margin(self.settings) * points.spacing
        return points.select(self._silhouettes.inside_hull(points.points, margin))

    def constraints(self, points: PointLevel, grid: PointGrid) -> Constraints:
        """Distances stay inside the visual hull, and start at the photo hull."""
        if not self.settings.sdf.enabled:
            return Constraints()
        length_unit = grid_spacing(self.settings.grid_res, 0)
        hull_distance = self._silhouettes.distance(points.points) / length_unit
        neighbors = grid_neighbors(grid.positions, points.spacing)
        make = partial(SdfConstraints, hull_distance[grid.order], neighbors, self.settings.sdf)
        if self._photo_hull is None:
            return make()
        initial_distance = self._photo_hull.distance(grid.positions) / length_unit
        return make(initial_distance, self._photo_hull.is_reliable)

    def refine(
        self, trainer: Trainer, confidence: ViewConfidence | None, generator: torch.Generator
    ) -> PointLevel:
        """Distances are refined beside the surface alone, whatever the views see."""
        if not self.settings.sdf.enabled:
            return super().refine(trainer, confidence, generator)
        raw, rgb = (parameter.detach() for parameter in trainer.field.point_parameters())
        return subdivide_narrow_band(trainer.points.positions, raw, rgb, trainer.spacing)

    def after_training(self, trainer: Trainer) -> tuple[int, Iterator[Float32[Tensor, ""]]]:
        """Colors alone."""
        refinement = self.settings.color_refinement
        return refinement.steps, refine_colors(trainer, refinement)


run = partial(pipeline.run, make_variant=PlusVariant)
