"""Section 3.3: training the field of one level on the photometric loss of its re-rendered views.

Reading R10: re-rendering the views is the only training signal.
"""

from collections.abc import Callable
from functools import cached_property
from typing import Any

import torch
from jaxtyping import Bool, Float32, Int64
from torch import Tensor

from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf.confidence import ViewConfidence, compute_view_confidence
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.losses import depth_loss, opacity_regularizer, photometric_loss
from industnerf.methods.industnerf.optimizer import (
    Constraints,
    FieldAdam,
    beta_at,
    training_progress,
)
from industnerf.methods.industnerf.point_levels import (
    PointLevel,
    grid_spacing,
    level_name,
    level_settings,
    within_radius,
)
from industnerf.methods.industnerf.ray_sampler import (
    RayBatch,
    RaySampler,
    footprint,
    target_footprint,
)
from industnerf.methods.industnerf.scene import NerfScene
from industnerf.rendering.points import PointGrid
from industnerf.rendering.render import Renderer, RenderOutput, make_renderer
from industnerf.rendering.sdf_density import density
from industnerf.schema import IndustnerfSettings

REFRESH_INTERVAL = 20  # steps between updates of all points and all views; one more at the end
MAX_KEPT_FRACTION = 0.9  # of the points; to take out fewer is not worth sorting the rest


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
        make_constraints: Callable[[PointLevel, PointGrid], Constraints] | None = None,
    ) -> None:
        self.field, self.spacing, self.settings = field, points.spacing, settings
        self._scene, self.level, self._generator = scene, level, generator
        self.steps_done = 0
        self._build_renderers(points.points)
        self.constraints = Constraints()
        if make_constraints is not None:
            self.constraints = make_constraints(points, self.points)
        self._visible_points = self.constraints.visible_points(points.points, self.points.order)
        points = points.select(self.points.order)
        self._view_weights = points.view_weights
        raw, rgb = points.residuals or (None, None)
        raw = self.constraints.initial_raw(raw)
        self.field.set_points(points.points, raw, rgb, points.view_weights, spacing=points.spacing)
        self._update_beta()
        self._optimizer = FieldAdam(field)

    @property
    def num_steps(self) -> int:
        """Number of steps of this level."""
        return level_settings(self.settings, self.level).steps

    @property
    def image_px(self) -> int:
        """Longer side of the images that this level is trained on."""
        return level_settings(self.settings, self.level).image_px

    def _build_renderers(self, points: Float32[Tensor, "m 3"]) -> None:
        """Sort the points into cells, for the renderer of the training and the fine one."""
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
        # as of the last update; at first no point is known to be empty
        self.has_density = torch.ones(len(points), dtype=torch.bool, device=points.device)

    @cached_property
    def ray_sampler(self) -> RaySampler:
        """The images at the resolution of this level, and the pixels that can see its points."""
        return RaySampler(self._scene, self._visible_pixels(self._visible_points))

    def _visible_pixels(self, points: Float32[Tensor, "m 3"]) -> Bool[Tensor, "v h w"]:
        """The pixels of the target views that can see any of the points."""
        radius, reading = self.points.support_radius, self.settings.readings.target_views
        pixels = target_footprint(points, radius, self._scene.cameras, self.image_px, reading)
        if not pixels.any():
            raise ReconstructionFailed(
                f"no target view can see a point of {level_name(self.level)}: are there views "
                "enough, and do their cameras agree on where the part is?"
            )
        return pixels

    @property
    def _length_unit(self) -> float:
        """The unit of raw values: the first level's spacing."""
        return grid_spacing(self.settings.grid_res, 0)

    def _update_beta(self) -> None:
        """Set the softness of the surface to its value after the steps done."""
        if self.settings.readings.density_activation == "sdf":
            self.field.beta = self.beta()
            self.renderer.beta = self.field.beta * self._length_unit

    def fine_renderer(self, beta: float) -> Renderer:
        """The renderer of the trained field, with a surface of softness `beta`, in first spacings.

        Colors are rendered as soft as they were trained: seen at an angle, a soft surface is
        nearer than a hard one.  The median depth is always that of softness `beta.render`.
        """
        if self.settings.readings.density_activation == "sdf":
            self._fine_renderer.beta = beta * self._length_unit
            self._fine_renderer.median_beta = self.settings.beta.render * self._length_unit
        return self._fine_renderer

    def beta(self) -> float:
        """Softness of the surface after the steps done, in first spacings."""
        return beta_at(self.settings, self._progress())

    def _progress(self) -> float:
        return training_progress(self.settings, self.level, self.steps_done)

    def _prune_empty(self) -> None:
        """Skip empty space; of a field with N, drop the points that have no density near them.

        No pixel changes by it: a point is dropped only if it and all points that are ever
        interpolated with it have no density.  Raises ReconstructionFailed if no point has a
        density: then none has a gradient.
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
                f"the field is empty after {self.steps_done} steps of {level_name(self.level)}: do "
                "the images show anything but background?"
            )

    def _set_has_density(self, has_density: Bool[Tensor, "m"]) -> None:
        self.has_density = has_density
        self.points.update_occupancy(has_density)

    def _select_points(self, mask: Bool[Tensor, "m"]) -> Int64[Tensor, "k"]:
        """Drop the other points, with their moments in the optimizer.

        Returns the indices of the kept points in their new order: fewer points are sorted into
        other cells.
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
        """Take one step of Adam; returns the mean squared error of its pixels.

        To read that number is to wait for the device, which may be some steps behind.
        """
        beta, settings = self.beta(), self.settings
        self._optimizer.set_lrs(self._progress(), self.constraints.lr(beta))
        self._update_beta()
        if self._is_encoder_updated:
            self.field.refresh_views(self.steps_done, self._generator)
        output, batch = self.render_batch(*self.field())
        photometric = photometric_loss(output, batch.background, batch.target)
        loss = photometric + opacity_regularizer(
            output, settings.opacity_weight, settings.binary_opacity_weight
        )
        if batch.measured_depth is not None:
            loss = loss + settings.depth_weight * depth_loss(output, batch.measured_depth)
        self._optimizer.zero_grad()
        loss.backward()
        self._optimizer.step()
        self.field.clamp_parameters()
        self.constraints.project(self.field, beta, self.steps_done + 1, self.num_steps)
        self.steps_done += 1
        if self._is_refresh_step:
            self._prune_empty()
            if self._is_encoder_updated:
                self.field.source_features.recompute_features()  # no view is stale after it
        self._update_view_weights()
        return photometric.detach()

    def _update_view_weights(self) -> None:
        """Every `view_weights_interval` steps: the confidence (13) of each view, as it is now."""
        interval = self.settings.view_weights_interval
        is_due = interval and self.steps_done % interval == 0 and self.steps_done < self.num_steps
        if self._view_weights is None or not is_due:
            return
        confidence = self._compute_view_confidence(self.renderer, self.image_px // 2)
        self._view_weights = confidence.per_view
        self.field.set_view_weights(self._view_weights)

    def render_batch(
        self, values: Float32[Tensor, "m"], rgb: Float32[Tensor, "m 3"]
    ) -> tuple[RenderOutput, RayBatch]:
        """Render `rays_per_step` random pixels of points with these values and colors."""
        settings = self.settings
        batch = self.ray_sampler.sample(
            settings.rays_per_step, settings.image_noise, self._generator
        )
        return self.renderer.render(batch.rays, values, rgb), batch

    @torch.no_grad()
    def values(self) -> tuple[Tensor, Tensor]:
        """Densities (reading `sdf`: distances) and colors of the points, as they are now."""
        return self.field()

    @torch.no_grad()
    def density(self) -> Tensor:
        """Densities of the points, as they are now."""
        return density(self.field()[0], self.renderer.beta)

    def view_confidence(self) -> ViewConfidence:
        """Section 3.4: confidence of the source views in the points, of the last level finely.

        Raises ReconstructionFailed if no point has a density.
        """
        self._update_beta()  # a restored trainer has not taken the last step itself
        if self.level < len(self.settings.levels) - 1:
            return self._compute_view_confidence(self.renderer, self.image_px // 2)
        renderer = self.fine_renderer(self.settings.beta.render)
        return self._compute_view_confidence(renderer, self.settings.surface_px)

    def _compute_view_confidence(self, renderer: Renderer, image_px: int) -> ViewConfidence:
        """The confidence of the source views in the points, at this size of the views."""
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
        """Whether `state` is all that later steps depend on.

        `restore` encodes all views with E as it is.  While E is trained that is what they are
        just after all views were recomputed, not between.
        """
        return self._is_refresh_step or not self._is_encoder_updated

    @property
    def _is_encoder_updated(self) -> bool:
        return self.field.is_encoder_updated(self.level)

    @property
    def _is_refresh_step(self) -> bool:
        """Whether the last step ended with an update of all points and all views."""
        return self.steps_done % REFRESH_INTERVAL == 0 or self.steps_done == self.num_steps

    def state(self) -> dict[str, Any]:
        """All that later steps depend on, but for the encoded views: see `is_checkpointable`."""
        return {
            "steps_done": self.steps_done,
            "points": self.points.positions,
            "spacing": self.spacing,
            "view_weights": self._view_weights,
            "has_density": self.has_density,
            "field": self.field.state_dict(),
            "optimizer": self._optimizer.state_dict(),
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Continue from `state`, which is of the same points; encodes all views anew."""
        self.steps_done = state["steps_done"]
        self.field.load_state_dict(state["field"])
        if self.field.source_features:
            self.field.source_features.recompute_features()
        self._optimizer.load_state_dict(state["optimizer"])
        self._set_has_density(state["has_density"].to(self.points.positions.device))
        self._update_beta()
