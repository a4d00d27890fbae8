"""Section 3.1, eq. (4): density and color of the cloud points.

    raw, rgb = N(pooled features, PosE) + residual

The paper's method has no residuals.  A field without N is one of free points, as in `nerf`.
"""

import torch
from jaxtyping import Float32, Int64
from torch import Tensor, nn

from industnerf.methods.industnerf.network import Network, activate
from industnerf.methods.industnerf.point_levels import grid_spacing
from industnerf.methods.industnerf.scene import NerfScene, source_target_split
from industnerf.methods.industnerf.source_features import GRAY, SourceFeatures
from industnerf.schema import IndustnerfSettings

EMPTY_RAW_DENSITY = -6.5  # has no density, and is near enough to one to return
MIN_STD = 1e-2  # inputs that vary less are not scaled up to a deviation of 1


def mean_and_std(
    inputs: Float32[Tensor, "m c"],
) -> tuple[Float32[Tensor, "c"], Float32[Tensor, "c"]]:
    """Mean and standard deviation of each column; a single row deviates by nothing."""
    rows = inputs.detach()
    deviation = rows.std(0) if len(rows) > 1 else torch.zeros_like(rows[0])
    return rows.mean(0), deviation.clamp(min=MIN_STD)


class Field(nn.Module):
    """The field at the points of one level; `set_points` moves it to the next."""

    def __init__(self, scene: NerfScene, settings: IndustnerfSettings) -> None:
        super().__init__()
        self._settings = settings
        self._length_unit = grid_spacing(settings.grid_res, 0)  # density is per first spacing
        self._source_views = source_target_split(settings.readings.target_views).source
        self.source_features = self.network = None
        self.beta = 1.0  # softness, in first spacings: the unit of N's distances
        self._has_view_weights = False
        self._normalized: tuple[int, Tensor] | None = None  # `num_changes`, and N's inputs then
        self.register_buffer("_mean", torch.zeros(0))
        self.register_buffer("_deviation", torch.zeros(0))
        if settings.network.enabled:
            self.source_features = SourceFeatures(scene[self._source_views], settings)
            self.network = Network(
                self.source_features.out_channels,
                settings.network.hidden_dim,
                settings.network.hidden_layers,
                settings.density_bias,
                settings.network.density_scale,
            )

    def set_points(
        self,
        points: Float32[Tensor, "m 3"],
        raw: Float32[Tensor, "m"] | None = None,
        rgb: Float32[Tensor, "m 3"] | None = None,
        view_weights: Float32[Tensor, "v m"] | None = None,
        spacing: float = 0.0,
    ) -> None:
        """Be the field at these points from now on.

        `raw` and `rgb` are the residuals to start from; without N they are all of the field.
        `view_weights` is the confidence (13) of each source view in each point, None before any
        level is trained.  `spacing` is as for `SourceFeatures.set_points`.
        """
        count, device = len(points), points.device
        if self.source_features is not None:
            if view_weights is not None:
                view_weights = view_weights[self._source_views]
            self._set_source_points(points, view_weights, spacing)
        if self._settings.residual.enabled:
            is_free = self.network is None
            initial_raw, gray = (self._settings.density_bias, GRAY) if is_free else (0.0, 0.0)
            raw = torch.full((count,), initial_raw, device=device) if raw is None else raw
            rgb = torch.full((count, 3), gray, device=device) if rgb is None else rgb
            self.raw, self.rgb = nn.Parameter(raw.clone()), nn.Parameter(rgb.clone())

    def _set_source_points(
        self,
        points: Float32[Tensor, "m 3"],
        view_weights: Float32[Tensor, "v m"] | None,
        spacing: float,
    ) -> None:
        """Compute N's inputs at these points, normalized by the statistics of the first grid.

        Pooling with view weights changes the statistics.  When the first weights arrive, the new
        inputs are rescaled to the mean and deviation that N was trained on.
        """
        self.source_features.set_points(points, spacing)
        mean, std = mean_and_std(self.source_features())
        if not self._mean.numel():
            self._mean, self._deviation = mean, std
        if view_weights is None:
            return
        self.source_features.set_view_weights(view_weights)
        if not self._has_view_weights:
            self._has_view_weights = True
            new_mean, new_std = mean_and_std(self.source_features())
            self._mean = new_mean + (self._mean - mean) * new_std / std
            self._deviation = self._deviation * new_std / std

    @property
    def is_encoder_trainable(self) -> bool:
        """Whether E is trained on this part."""
        return self.source_features is not None and self.source_features.is_trainable

    def set_view_weights(self, view_weights: Float32[Tensor, "v m"]) -> None:
        """Pool by the confidence (13) of each view in each point, as it is now; reading R3.

        N's inputs are rescaled as those of the level's first weights were.
        """
        if self.source_features is not None:
            self.source_features.set_view_weights(view_weights[self._source_views])

    def is_encoder_updated(self, level: int) -> bool:
        """Whether E is trained at this level."""
        return self.is_encoder_trainable and level < self._settings.network.encoder_update_levels

    def refresh_views(self, step: int, generator: torch.Generator) -> None:
        """At every so-many-th step, encode some random views anew, differentiably in E."""
        settings = self._settings.network
        if step % settings.encoder_update_interval == 0:
            views = torch.randperm(len(self.source_features), generator=generator)
            views = views[: settings.encoder_update_views]
            self.source_features.refresh_views(views, generator)

    def select_points(self, indices: Int64[Tensor, "k"]) -> None:
        """Be the field at these of the points from now on, in this order."""
        if self.source_features is not None:
            self.source_features.select_points(indices)
        if self._settings.residual.enabled:
            self.raw, self.rgb = nn.Parameter(self.raw[indices]), nn.Parameter(self.rgb[indices])

    def forward(self) -> tuple[Float32[Tensor, "m"], Float32[Tensor, "m 3"]]:
        """Density (reading `sdf`: signed distance) and color of every point."""
        raw, rgb = self._network_output() if self.network is not None else (0.0, 0.0)
        if self._settings.residual.enabled:
            raw, rgb = raw + self.raw, rgb + self.rgb
        reading, maximum = (
            self._settings.readings.density_activation,
            self._settings.max_raw_density,
        )
        return activate(raw, reading, self._length_unit, maximum), rgb.clamp(0, 1)

    def _network_output(self) -> tuple[Float32[Tensor, "m"], Float32[Tensor, "m 3"]]:
        """Raw values and colors from N."""
        raw, rgb = self.network(self._network_inputs(), self.source_features.pooled_colors())
        return raw * self.beta, rgb

    def _network_inputs(self) -> Float32[Tensor, "m c"]:
        """Normalized inputs, kept while they do not change: to make them costs as much as N."""
        num_changes = self.source_features.num_changes
        if self._normalized is not None and self._normalized[0] == num_changes:
            return self._normalized[1]
        inputs = (self.source_features() - self._mean) / self._deviation
        self._normalized = None if inputs.requires_grad else (num_changes, inputs)
        return inputs

    @torch.no_grad()
    def clamp_parameters(self) -> None:
        """Clamp free points, after a step, to the range where they have a gradient."""
        if self._settings.residual.enabled and self.network is None:
            self.rgb.clamp_(0, 1)
            activation = self._settings.readings.density_activation
            if activation != "sdf":
                # `relu` still has a gradient at 0; `truncated_exp` is 0 from just above EMPTY
                minimum = 0 if activation == "relu" else EMPTY_RAW_DENSITY
                self.raw.clamp_(minimum, self._settings.max_raw_density)

    def num_parameters(self) -> int:
        """Number of trained values: of E, of N, and of the points."""
        num_trainable = sum(p.numel() for p in self.parameters() if p.requires_grad)
        return num_trainable - (self.network.num_pruned if self.network is not None else 0)

    def point_parameters(self) -> list[nn.Parameter]:
        """The residuals, a row a point."""
        return [self.raw, self.rgb] if self._settings.residual.enabled else []

    def param_groups(self) -> list[dict]:
        """The parameters and their initial learning rates, as `torch.optim` takes them."""
        network_settings, residual_settings = self._settings.network, self._settings.residual
        param_groups = []
        if self.network is not None:
            encoder = [p for p in self.source_features.parameters() if p.requires_grad]
            param_groups = [
                {"params": list(self.network.mlp_parameters()), "lr": network_settings.lr},
                {"params": list(self.network.skip.parameters()), "lr": network_settings.skip_lr},
                {"params": encoder, "lr": network_settings.encoder_lr},
            ]
        if residual_settings.enabled:
            param_groups += [
                {"params": [self.raw], "lr": residual_settings.density_lr},
                {"params": [self.rgb], "lr": residual_settings.color_lr},
            ]
        return [group for group in param_groups if group["params"]]


class SharedModules(nn.Module):
    """E and N alone, which several parts may share: reading R14 `pretrained`."""

    def __init__(self, field: Field) -> None:
        super().__init__()
        self.encoder, self.network = field.source_features.encoder, field.network

    def share_with(self, field: Field) -> None:
        """Replace E and N of `field` by these, which it then trains."""
        field.source_features.encoder, field.network = self.encoder, self.network
