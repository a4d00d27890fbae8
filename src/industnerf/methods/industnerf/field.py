"""Densities and colors of the cloud points: N of eq. (4), and what each point learns by itself.

    raw, rgb = N(pooled features, PosE) + residual

Without residuals this is the paper's method; without N it is a field of free points.
"""

import torch
from jaxtyping import Float32, Int64
from torch import Tensor, nn

from industnerf.methods.industnerf.network import Network, activate
from industnerf.methods.industnerf.point_levels import grid_spacing
from industnerf.methods.industnerf.scene import NerfScene
from industnerf.methods.industnerf.source_features import GRAY, SourceFeatures
from industnerf.methods.industnerf.view_split import source_target_split
from industnerf.schema import IndustnerfSettings

EMPTY_RAW_DENSITY = (
    -6.5
)  # raw density that is nothing, by some margin, and not too far to come back from
MIN_STD = 1e-2  # deviation that an input is raised to 1 from; below, it is told as good as nothing


def mean_and_std(
    inputs: Float32[Tensor, "m c"],
) -> tuple[Float32[Tensor, "c"], Float32[Tensor, "c"]]:
    """Mean and deviation of each column."""
    return inputs.detach().mean(0), inputs.detach().std(0).clamp(min=MIN_STD)


class Field(nn.Module):
    """The field at the points that were placed last."""

    def __init__(self, scene: NerfScene, settings: IndustnerfSettings) -> None:
        super().__init__()
        self._settings = settings
        self._length_unit = grid_spacing(
            settings.grid_res, 0
        )  # density is counted per first spacing
        self._source_views = source_target_split(settings.readings.target_views).source
        self.source_features = (
            SourceFeatures(scene[self._source_views], settings)
            if settings.network.enabled
            else None
        )
        self.beta = 1.0  # of the surface, in first spacings: what N counts distances in
        self._has_view_weights = False  # whether views are trusted more and less yet
        self.register_buffer("_mean", torch.zeros(0))
        self.register_buffer("_deviation", torch.zeros(0))
        self.network = (
            Network(
                self.source_features.out_channels,
                settings.network.hidden_dim,
                settings.network.hidden_layers,
                settings.density_bias,
                settings.network.density_scale,
            )
            if self.source_features is not None
            else None
        )

    def set_points(
        self,
        points: Float32[Tensor, "m 3"],
        raw: Float32[Tensor, "m"] | None = None,
        rgb: Float32[Tensor, "m 3"] | None = None,
        view_weights: Float32[Tensor, "v m"] | None = None,
        spacing: float = 0.0,
    ) -> None:
        """From now on be the field at these points; `raw` and `rgb` are residuals to start from.

        Raw density and color are wholly residual where there is no network.  `trust` is how
        sure each source view was of the points, or None before any has been asked; `spacing` is
        how far apart they are, see `Sources.place`.
        """
        count, device = len(points), points.device
        if self.source_features is not None:
            self._set_source_points(
                points, None if view_weights is None else view_weights[self._source_views], spacing
            )
        if self._settings.residual.enabled:
            without_network = self.network is None
            initial_raw = self._settings.density_bias if without_network else 0.0
            raw = torch.full((count,), initial_raw, device=device) if raw is None else raw
            color = GRAY if without_network else 0.0
            rgb = torch.full((count, 3), color, device=device) if rgb is None else rgb
            self.raw, self.rgb = nn.Parameter(raw.clone()), nn.Parameter(rgb.clone())

    def _set_source_points(
        self,
        points: Float32[Tensor, "m 3"],
        view_weights: Float32[Tensor, "v m"] | None,
        spacing: float,
    ) -> None:
        """Have N's inputs of these points, counted in deviations as the first grid has them.

        Views that are trusted say something else than all alike, from which N has learned.  When
        they are first heeded, their mean and deviation over the points are made what N is used to.
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

    def recompute_features(self) -> None:
        """Have all views told by E as it is now: what N learns of stale ones is soon wrong."""
        if self.source_features is not None and self.source_features.is_trainable:
            self.source_features.recompute_features()

    def select_points(self, indices: Int64[Tensor, "k"]) -> None:
        """From now on be the field at these of the points, in this order."""
        if self.source_features is not None:
            self.source_features.select_points(indices)
        if self._settings.residual.enabled:
            self.raw, self.rgb = nn.Parameter(self.raw[indices]), nn.Parameter(self.rgb[indices])

    def forward(
        self,
    ) -> tuple[Float32[Tensor, "m"], Float32[Tensor, "m 3"]]:
        """Density (reading `distance`: signed distance) and color of every point."""
        raw, rgb = self._network_output() if self.network is not None else (0.0, 0.0)
        if self._settings.residual.enabled:
            raw, rgb = raw + self.raw, rgb + self.rgb
        readings, ceiling = self._settings.readings, self._settings.max_raw_density
        return activate(raw, readings.density_activation, self._length_unit, ceiling), rgb.clamp(
            0, 1
        )

    def _network_output(self) -> tuple[Float32[Tensor, "m"], Float32[Tensor, "m 3"]]:
        """What N makes of the sources."""
        inputs = (self.source_features() - self._mean) / self._deviation
        raw, rgb = self.network(inputs, self.source_features.pooled_colors())
        return raw * self.beta, rgb

    @torch.no_grad()
    def clamp_parameters(self) -> None:
        """After a step, bring what points learn by themselves back to where it means something."""
        if self._settings.residual.enabled and self.network is None:
            self.rgb.clamp_(0, 1)
            activation = self._settings.readings.density_activation
            if activation != "sdf":
                # at 0 `relu` still has its gradient; `cut_exp` is 0 from some way above EMPTY
                self.raw.clamp_(
                    0 if activation == "relu" else EMPTY_RAW_DENSITY, self._settings.max_raw_density
                )

    def num_parameters(self) -> int:
        """How many numbers are learned: of E, of N, and of the points themselves."""
        num_trainable = sum(p.numel() for p in self.parameters() if p.requires_grad)
        return num_trainable - (self.network.num_pruned if self.network is not None else 0)

    def point_parameters(self) -> list[nn.Parameter]:
        """What points learn by themselves, a row a point."""
        return [self.raw, self.rgb] if self._settings.residual.enabled else []

    def param_groups(self) -> list[dict]:
        """What an optimizer learns, and how fast."""
        network_settings, residual_settings = self._settings.network, self._settings.residual
        param_groups = []
        if self.network is not None:
            param_groups = [
                {"params": list(self.network.mlp_parameters()), "lr": network_settings.lr},
                {"params": list(self.network.skip.parameters()), "lr": network_settings.skip_lr},
                {"params": self._encoder_parameters(), "lr": network_settings.encoder_lr},
            ]
        if residual_settings.enabled:
            param_groups += [
                {"params": [self.raw], "lr": residual_settings.density_lr},
                {"params": [self.rgb], "lr": residual_settings.color_lr},
            ]
        return [group for group in param_groups if group["params"]]

    def _encoder_parameters(self) -> list[nn.Parameter]:
        return [p for p in self.source_features.parameters() if p.requires_grad]
