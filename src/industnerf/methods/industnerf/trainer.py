"""Learning the field of one level: re-rendering the source views is the only signal, R10."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import torch
from jaxtyping import Bool, Float32, Int64
from torch import Tensor

from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf.beta_schedule import beta_at, level_settings, training_progress
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.losses import depth_loss, opacity_regularizer, photometric_loss
from industnerf.methods.industnerf.optimizer import FieldAdam
from industnerf.methods.industnerf.point_levels import (
    PointLevel,
    grid_spacing,
    level_name,
    within_radius,
)
from industnerf.methods.industnerf.ray_sampler import RaySampler, add_noise, footprint
from industnerf.methods.industnerf.scene import NerfScene
from industnerf.methods.industnerf.view_confidence import ViewConfidence, compute_view_confidence
from industnerf.methods.industnerf.view_split import source_target_split
from industnerf.methods.industnerf_plus.photo_hull import PhotoHull
from industnerf.methods.industnerf_plus.sdf_constraints import SdfConstraints, grid_neighbors
from industnerf.methods.industnerf_plus.silhouette_carving import Silhouettes
from industnerf.rendering.points import PointGrid
from industnerf.rendering.render import Renderer, RenderOutput, make_renderer
from industnerf.rendering.sdf_density import density
from industnerf.schema import IndustnerfSettings

REFRESH_INTERVAL = (
    20  # steps from one look at all points, and at all views, to the next; one at the end
)
VISIBILITY_MARGIN = (
    1.0  # first spacings beyond the hull: no pixel that is farther tells anything new
)
MAX_KEPT_FRACTION = 0.9  # of the points; if more are needed, sorting out the rest is not worth it


@dataclass(frozen=True)
class RayBatch:
    """What was seen along some rays, and what should have been."""

    output: RenderOutput
    background: Float32[Tensor, "r 3"]
    target: Float32[Tensor, "r 3"]
    measured_depth: Float32[Tensor, "r"] | None  # depth along the ray, where a sensor reads one


class Trainer:
    """The optimization of one level, a step at a time."""

    def __init__(
        self,
        scene: NerfScene,
        field: Field,
        points: PointLevel,
        level: int,
        settings: IndustnerfSettings,
        generator: torch.Generator,
        silhouettes: Silhouettes | None = None,
        photo_hull: PhotoHull | None = None,
    ) -> None:
        self.field, self.spacing, self.settings = field, points.spacing, settings
        self._scene, self.level, self._generator = scene, level, generator
        self.steps_done = 0
        positions = points.points
        hull_distance = (
            silhouettes.distance(positions) / self._length_unit if settings.sdf.enabled else None
        )
        self._build_renderers(positions)
        self._visible_points = (
            positions if hull_distance is None else positions[hull_distance < VISIBILITY_MARGIN]
        )
        points = points.select(self.points.order)
        self._view_weights = points.view_weights
        self.sdf_constraints = (
            None
            if hull_distance is None
            else self._make_sdf_constraints(hull_distance[self.points.order], photo_hull)
        )
        raw, rgb = points.residuals or (None, None)
        raw = self.sdf_constraints.initial_sdf(raw) if self.sdf_constraints else raw
        self.field.set_points(points.points, raw, rgb, points.view_weights, spacing=points.spacing)
        self._update_beta()
        self._optimizer = FieldAdam(field)

    @property
    def num_steps(self) -> int:
        """How many this level takes."""
        return level_settings(self.settings, self.level).steps

    @property
    def image_px(self) -> int:
        """The longer side of the images that this level looks at."""
        return level_settings(self.settings, self.level).image_px

    def _build_renderers(self, points: Float32[Tensor, "m 3"]) -> None:
        """Sort the points into cells, for two renderers that look at them; none is known empty."""
        settings = self.settings
        support_radius, half_extent = settings.neighbor_radius * self.spacing, 1 + self.spacing
        self.points = PointGrid(
            points, support_radius, settings.neighbors, settings.readings.interpolation
        )
        box = (-half_extent,) * 3, (half_extent,) * 3
        self.renderer = make_renderer(
            settings.renderer,
            self.points,
            *box,
            settings.step_size * self.spacing,
            settings.early_stop_transmittance,
        )
        self._fine_renderer = make_renderer(
            settings.renderer,
            self.points,
            *box,
            settings.fine_step_size * self.spacing,
            settings.early_stop_transmittance,
        )
        # which points had a density when it was last looked for
        self.has_density = torch.ones(len(points), dtype=torch.bool, device=points.device)

    @cached_property
    def ray_sampler(self) -> RaySampler:
        """The images, at the resolution that is learned from; found when first asked for."""
        return RaySampler(self._scene, self._visible_pixels(self._visible_points))

    def _visible_pixels(self, points: Float32[Tensor, "m 3"]) -> Bool[Tensor, "v h w"]:
        """The pixels of judging views that can show any of the points."""
        visible = footprint(points, self.points.support_radius, self._scene.cameras, self.image_px)
        target_pixels = torch.zeros_like(visible)
        target_views = source_target_split(self.settings.readings.target_views).target
        target_pixels[target_views] = visible[target_views]
        if not target_pixels.any():
            raise ReconstructionFailed(
                f"no source view can show a point of {level_name(self.level)}: are there views "
                "enough, and do their cameras agree on where the part is?"
            )
        return target_pixels

    def _make_sdf_constraints(
        self, hull_distance: Float32[Tensor, "m"], photo_hull: PhotoHull | None
    ) -> SdfConstraints:
        points = self.points.positions
        neighbors, settings = grid_neighbors(points, self.spacing), self.settings.sdf
        if photo_hull is None:
            return SdfConstraints(hull_distance, neighbors, settings)
        initial_distance = photo_hull.distance(points) / self._length_unit
        return SdfConstraints(
            hull_distance, neighbors, settings, initial_distance, photo_hull.is_reliable
        )

    @property
    def _length_unit(self) -> float:
        """That raw values are counted in: the first level's spacing."""
        return grid_spacing(self.settings.grid_res, 0)

    def _update_beta(self) -> None:
        """Bring the softness of the surface to where it is after the steps taken."""
        if self.settings.readings.density_activation == "sdf":
            self.field.beta = self.beta()
            self.renderer.beta = self.field.beta * self._length_unit

    def fine_renderer(self, beta: float) -> Renderer:
        """What looks at the field once it is learned, with a surface so soft, in first spacings.

        As the last step had it for colors, which is what was learned: seen aslant, a soft surface
        is nearer than a hard one.  The median is that of `softness.shown`, whatever the colors'.
        """
        if self.settings.readings.density_activation == "sdf":
            self._fine_renderer.beta = beta * self._length_unit
            self._fine_renderer.median_beta = self.settings.beta.render * self._length_unit
        return self._fine_renderer

    def beta(self) -> float:
        """Of the surface after the steps taken, in first spacings."""
        return beta_at(self.settings, self._progress())

    def _progress(self) -> float:
        return training_progress(self.settings, self.level, self.steps_done)

    def _prune_empty(self) -> None:
        """Skip space that is empty; points that have nothing near them leave the set.

        No pixel changes by it: a point is left out only where it and all points that are ever
        weighed together with it have no density.  Raises ReconstructionFailed if none has any:
        from there no gradient leads back.
        """
        sigma = self.density()
        self._raise_if_empty(sigma)
        if self.field.network is not None:
            is_near_density = within_radius(
                self.points.positions, sigma > 0, 2 * self.points.support_radius
            )
            if is_near_density.float().mean() < MAX_KEPT_FRACTION:
                sigma = sigma[self._select_points(is_near_density)]
        self._set_has_density(sigma > 0)

    def _raise_if_empty(self, sigma: Float32[Tensor, "m"]) -> None:
        if not (sigma > 0).any():
            raise ReconstructionFailed(
                f"the field is empty after {self.steps_done} steps of {level_name(self.level)}: do the "
                "images show anything but background?"
            )

    def _set_has_density(self, has_density: Bool[Tensor, "m"]) -> None:
        self.has_density = has_density
        self.points.update_occupancy(has_density)

    def _select_points(self, mask: Bool[Tensor, "m"]) -> Int64[Tensor, "k"]:
        """Take the other points out of the set; the optimizer goes on with these where it was.

        Returns which they are, in their new order: fewer points have other cells to sort by.
        """
        remaining = self.points.positions[mask]
        self._build_renderers(remaining)
        self.ray_sampler = self.ray_sampler.with_mask(self._visible_pixels(remaining))
        self._update_beta()
        indices = mask.nonzero()[:, 0][self.points.order]
        self._view_weights = None if self._view_weights is None else self._view_weights[:, indices]
        self._optimizer.select_points(indices)
        return indices

    def step(self) -> Float32[Tensor, ""]:
        """One step of Adam; returns the mean squared error of the pixels it looked at.

        Who reads that number waits for the device, which may otherwise be some steps behind.
        """
        self._optimizer.set_lrs(self._progress(), self._sdf_lr() if self.sdf_constraints else None)
        self._update_beta()
        if self._is_encoder_step():
            self.field.source_features.refresh_views(self._random_views(), self._generator)
        batch = self.render_batch(*self.field())
        output = batch.output
        loss = photometric_loss(output, batch.background, batch.target)
        self._optimizer.zero_grad()
        regularizer = opacity_regularizer(
            output, self.settings.opacity_weight, self.settings.binary_opacity_weight
        )
        (
            loss
            + regularizer
            + depth_loss(output, batch.measured_depth, self.settings.depth_weight)
        ).backward()
        self._optimizer.step()
        self.field.clamp_parameters()
        if self.sdf_constraints:
            self.sdf_constraints.relax_to_initial(self.field.raw, self._sdf_lr())
            self.sdf_constraints.constrain(self.field.raw, self.steps_done + 1, self.num_steps)
        self.steps_done += 1
        if self._is_refresh_step:
            self._prune_empty()
            self.field.recompute_features()
        return loss.detach()

    def render_batch(self, values: Float32[Tensor, "m"], rgb: Float32[Tensor, "m 3"]) -> RayBatch:
        """Look along the rays of `rays` random pixels at points that hold these."""
        pixel_indices, offsets = self.ray_sampler.sample_pixels(
            self.settings.rays_per_step, self._generator
        )
        rays, target, background = self.ray_sampler.rays(pixel_indices, offsets)
        output = self.renderer.render(rays, values, rgb)
        target = add_noise(target, self.settings.image_noise, self._generator)
        return RayBatch(
            output, background, target, self.ray_sampler.ray_depths(pixel_indices, rays)
        )

    def _sdf_lr(self) -> float:
        """Of distances, in this step."""
        return self.sdf_constraints.lr(self.beta())

    def _is_encoder_step(self) -> bool:
        source_features = self.field.source_features
        return bool(
            source_features
            and source_features.is_trainable
            and self.steps_done % self.settings.network.encoder_update_interval == 0
        )

    def _random_views(self) -> Tensor:
        num_views = len(self.field.source_features)
        return torch.randperm(num_views, generator=self._generator)[
            : self.settings.network.encoder_update_views
        ]

    @torch.no_grad()
    def values(self) -> tuple[Tensor, Tensor]:
        """What the renderer is given of the points, as they are now: densities or distances."""
        return self.field()

    @torch.no_grad()
    def density(self) -> Tensor:
        """Of the points, as they are now."""
        return density(self.field()[0], self.renderer.beta)

    def view_confidence(self) -> ViewConfidence:
        """What the source views say of the points: the last level's finely, others' as trained.

        Raises ReconstructionFailed if no point has a density.
        """
        self._update_beta()  # as soft as after the last step, whether it was taken just now or not
        is_last_level = self.level == len(self.settings.levels) - 1
        renderer = self.fine_renderer(self.settings.beta.render) if is_last_level else self.renderer
        image_px = self.settings.surface_px if is_last_level else self.image_px // 2
        values, rgb = self.values()
        sigma = density(values, renderer.beta)
        self._raise_if_empty(sigma)
        self._set_has_density(sigma > 0)
        support_radius, cameras = self.points.support_radius, self._scene.cameras
        visible = footprint(self.points.positions[sigma > 0], support_radius, cameras, image_px)
        ray_sampler = RaySampler(self._scene, visible)
        return compute_view_confidence(
            self._scene, ray_sampler, renderer, values, rgb, self.settings.readings
        )

    @property
    def is_checkpointable(self) -> bool:
        """Whether `state` is all that a later step depends on.

        While E learns it is only just after all views were told by E as it is: `restore` has them
        told so, and between two such looks some are told by an E of some steps ago.
        """
        source_features = self.field.source_features
        return not (source_features and source_features.is_trainable) or self._is_refresh_step

    @property
    def _is_refresh_step(self) -> bool:
        """Whether the last step ended with a look at all points and all views."""
        return self.steps_done % REFRESH_INTERVAL == 0 or self.steps_done == self.num_steps

    def state(self) -> dict[str, Any]:
        """All that a later step depends on, but what E made of the views: see `can_stop`."""
        return {
            "taken": self.steps_done,
            "points": self.points.positions,
            "spacing": self.spacing,
            "trust": self._view_weights,
            "filled": self.has_density,
            "field": self.field.state_dict(),
            "adam": self._optimizer.state_dict(),
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from `state`, which was taken of the same points.

        What the source views say is not in it, but encoded anew, every view by E as it is now.
        """
        self.steps_done = state["taken"]
        self.field.load_state_dict(state["field"])
        if self.field.source_features:
            self.field.source_features.recompute_features()
        self._optimizer.load_state_dict(state["adam"])
        self._set_has_density(state["filled"].to(self.points.positions.device))
        self._update_beta()
