"""The additions of `industnerf_plus`, put together as a variant of the paper's method."""

from functools import partial
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Int32

from industnerf.geometry.isosurface import isosurface, off_zero
from industnerf.methods.industnerf import pipeline
from industnerf.methods.industnerf.optimizer import Constraints
from industnerf.methods.industnerf.pipeline import Callback, ReconstructionResult, Reconstructor
from industnerf.methods.industnerf.point_levels import PointLevel, grid_spacing
from industnerf.methods.industnerf.scene import NerfScene, PosedImages
from industnerf.methods.industnerf.variant import Variant
from industnerf.methods.industnerf_plus.adaptive_resolution import adapt_resolution, hull_margin
from industnerf.methods.industnerf_plus.appearance import Appearance
from industnerf.methods.industnerf_plus.caves import fill_caves
from industnerf.methods.industnerf_plus.distance_grid import DistanceGrid, from_points, hull_grid
from industnerf.methods.industnerf_plus.openings import open_recesses
from industnerf.methods.industnerf_plus.photo_hull import PhotoHull
from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.polish import Polisher
from industnerf.methods.industnerf_plus.recesses import cut_recesses
from industnerf.methods.industnerf_plus.rerender import render_views
from industnerf.methods.industnerf_plus.sdf_constraints import SdfConstraints, grid_neighbors
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays, ShadedSurface
from industnerf.methods.industnerf_plus.silhouette_carving import Silhouettes
from industnerf.methods.industnerf_plus.surface_cloud import sample_visible_surface
from industnerf.photohull.voxel_grid import unit_frame_cameras_about
from industnerf.rendering.points import PointGrid
from industnerf.schema import IndustnerfPlusSettings
from industnerf.torch_kernels import use_reproducible_kernels

LIGHT_WARNING = (
    "no few distant lights explain the brightness of the photographs (polish.max_light_outliers), "
    "so the surface is found by colors alone; does the part shine or have a texture, or did a "
    "light move?"
)
FEW_PIXELS_WARNING = (
    "too few pixels are inside the part and away from its edges to fit a light to, so the surface "
    "is found by colors alone; larger photographs, or ones that the part fills, have more"
)


class PlusVariant(Variant):
    """Each addition is used if the settings enable it."""

    settings: IndustnerfPlusSettings

    def __init__(
        self, scene: NerfScene, posed: PosedImages, settings: IndustnerfPlusSettings
    ) -> None:
        super().__init__(scene, posed, settings)
        self.silhouettes: Silhouettes | None = None
        self._photo_hull: PhotoHull | None = None
        if settings.silhouette_carving:
            self.silhouettes = Silhouettes(scene, settings.background_tolerance)
            self.settings = adapt_resolution(settings, self.silhouettes)
        if settings.sdf.init.enabled:
            outlines = self.silhouettes.outlines()
            self._photo_hull = PhotoHull(posed, outlines, settings.sdf.init)
            self.warnings = self._photo_hull.warnings

    def initial_points(self, points: PointLevel) -> PointLevel:
        """The points in the visual hull, and somewhat beyond it."""
        if self.silhouettes is None:
            return points
        margin = hull_margin(self.settings) * points.spacing
        return points.select(self.silhouettes.inside_hull(points.points, margin))

    def constraints(self, points: PointLevel, grid: PointGrid) -> Constraints:
        """Distances stay inside the visual hull, and start at the photo hull."""
        if not self.settings.sdf.enabled:
            return Constraints()
        length_unit = grid_spacing(self.settings.grid_res, 0)
        hull_distance = self.silhouettes.distance(points.points) / length_unit
        neighbors = grid_neighbors(grid.positions, points.spacing)
        make = partial(SdfConstraints, hull_distance[grid.order], neighbors, self.settings.sdf)
        if self._photo_hull is None:
            return make()
        initial_distance = self._photo_hull.distance(grid.positions) / length_unit
        return make(initial_distance, self._photo_hull.is_reliable)


def run(
    posed: PosedImages,
    settings: IndustnerfPlusSettings,
    seed: int,
    callback: Callback | None = None,
    resume: dict[str, Any] | None = None,
) -> ReconstructionResult:
    """As `industnerf.pipeline.run`; with `polish` the trained field is where the polish starts.

    A run that is stopped in the polish resumes before it.
    """
    if not settings.polish.enabled:
        return pipeline.run(posed, settings, seed, callback, resume, make_variant=PlusVariant)
    use_reproducible_kernels()
    callback = callback or Callback()
    soft = Reconstructor(posed, settings, seed, callback, make_variant=PlusVariant)
    if resume:
        soft.restore(resume)
    while not soft.is_last_level:
        soft.train()
        soft.advance_level()
    soft.train()
    return PolishedSurface(soft, posed, seed, callback).result()


class PolishedSurface:
    """The surface of a trained field on a grid of its own, polished if the light is understood."""

    def __init__(
        self, soft: Reconstructor, posed: PosedImages, seed: int, callback: Callback
    ) -> None:
        self._soft, self._posed, self._seed, self._callback = soft, posed, seed, callback
        self._settings = soft.variant.settings.polish
        self._warnings = soft.variant.warnings
        self._level_starts = dict(soft.level_starts)
        background = soft.scene.background.cpu().numpy().astype(float)
        outlines = soft.variant.silhouettes.outlines()
        rig = unit_frame_cameras_about(posed.cameras, posed.center, posed.radius)
        hull = hull_grid(outlines, rig, self._settings.max_nodes)
        trainer = soft.trainer
        grid = from_points(
            hull,
            trainer.points.positions.cpu().numpy(),
            trainer.values()[0].cpu().numpy().ravel(),
            trainer.spacing,
        )
        self._surface = ShadedSurface(grid)
        self._rays = PinholeRays(posed.cameras, posed.center, posed.radius, grid)
        self._pictures = Pictures(posed.rgb, background, outlines)
        self._cell_px = grid.spacing / 2 * rig.min_diameter_px
        if self._settings.steps:
            self._move_by_shading()

    def _move_by_shading(self) -> None:
        """Put the surface right in steps, and polish it, if light explains the pictures."""
        polisher = self._make_polisher()
        if not polisher.fit_light():
            self._go_without_light(FEW_PIXELS_WARNING)
        elif self._surface.finishes.outlier_share > self._settings.max_light_outliers:
            self._go_without_light(LIGHT_WARNING)
        else:
            for change in (self._fill_caves, self._cut_recesses, self._open_recesses):
                if change():
                    polisher = self._make_polisher()
                    polisher.fit_light()
            self._polish(polisher)

    def _go_without_light(self, warning: str) -> None:
        self._surface.without_light()
        self._callback.on_warning(warning)
        self._warnings = (*self._warnings, warning)

    def _make_polisher(self) -> Polisher:
        """One that starts at the surface as it is."""
        return Polisher(
            self._surface, self._rays, self._pictures, self._cell_px, self._settings, self._seed
        )

    def _fill_caves(self) -> int:
        caves = self._soft.variant.settings.caves
        return fill_caves(self._surface, self._rays, self._pictures, caves)

    def _cut_recesses(self) -> int:
        recesses = self._soft.variant.settings.recesses
        return cut_recesses(self._surface, self._rays, self._pictures, recesses)

    def _open_recesses(self) -> int:
        openings = self._soft.variant.settings.openings
        return open_recesses(self._surface, self._rays, self._pictures, openings, self._seed)

    def _polish(self, polisher: Polisher) -> None:
        soft, callback, state = self._soft, self._callback, self._soft.state()
        self._level_starts["polish"] = len(soft.losses())
        callback.on_level_start("polish", self._settings.steps)
        for loss in polisher.steps():
            soft.record_step(torch.tensor(loss))
            if callback.wants_checkpoint():
                callback.on_checkpoint(state)

    def result(self) -> ReconstructionResult:
        """The cloud, and what renders the surface."""
        surface, posed, soft = self._surface, self._posed, self._soft
        appearance = Appearance(surface, self._rays, self._pictures)
        samples = sample_visible_surface(
            surface, self._rays, self._pictures, self._settings.points, self._seed
        )
        surface.set_node_albedo(appearance.albedo)
        candidates = posed.to_world(surface.grid.from_grid(samples.points))
        confidence = appearance.confidence(samples.points)
        is_seen = samples.view >= 0
        losses = soft.losses()
        return ReconstructionResult(
            candidates[is_seen],
            samples.colors[is_seen],
            confidence[is_seen],
            samples.view[is_seen].astype(np.int16),
            len(losses),
            soft.field.num_parameters(),
            candidates,
            np.where(is_seen, confidence, 0).astype(np.float32),
            losses,
            self._level_starts,
            self._pictures.background,
            partial(render_views, surface, posed.center, posed.radius),
            self._warnings,
            partial(mesh_of, surface.grid, posed),
        )


def mesh_of(
    grid: DistanceGrid, posed: PosedImages
) -> tuple[Float[np.ndarray, "v 3"], Int32[np.ndarray, "f 3"]]:
    """Vertices, in the frame and unit of the cameras, and faces of where the distance is 0."""
    vertices, faces = isosurface(off_zero(-grid.distance), 0.0, grid.lo, grid.spacing)
    return posed.center + posed.radius * vertices, faces
