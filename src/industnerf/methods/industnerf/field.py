"""Densities and colours of the cloud points: N of eq. (4), and what each point learns by itself.

    raw, rgb = N(pooled features, PosE) + residual

Without residuals this is the paper's method; without N it is a field of free points.
"""

import torch
from jaxtyping import Float32, Int64
from torch import Tensor, nn

from industnerf.methods.industnerf.levels import spacing_of
from industnerf.methods.industnerf.network import Network, activate
from industnerf.methods.industnerf.scene import Scene
from industnerf.methods.industnerf.sources import Sources
from industnerf.schema import IndustnerfSettings

EMPTY = -6.5  # raw density that is nothing, by some margin, and not too far to come back from
GREY = 0.5
SMALLEST = 1e-3  # deviation that an input is raised to 1 from; below, it is told as good as nothing


class Field(nn.Module):
    """The field at the points that were placed last."""

    def __init__(self, scene: Scene, settings: IndustnerfSettings) -> None:
        super().__init__()
        self._settings = settings
        self._unit = spacing_of(settings.grid_res, 0)  # density is counted per first spacing
        half = scene[::2] if settings.readings.signal == "left_out" else scene
        self.sources = Sources(half, settings) if settings.network.use else None
        self.register_buffer("_mean", torch.zeros(0))
        self.register_buffer("_deviation", torch.zeros(0))
        self.network = (
            Network(
                self.sources.columns,
                settings.network.hidden,
                settings.network.layers,
                settings.initial,
            )
            if self.sources is not None
            else None
        )

    def place(
        self,
        points: Float32[Tensor, "m 3"],
        raw: Float32[Tensor, "m"] | None = None,
        rgb: Float32[Tensor, "m 3"] | None = None,
    ) -> None:
        """From now on be the field at these points; `raw` and `rgb` are residuals to start from.

        Raw density and colour are wholly residual where there is no network.
        """
        m, device = len(points), points.device
        if self.sources is not None:
            self.sources.place(points)
            if not self._mean.numel():  # from the first grid on, inputs are counted in deviations
                inputs = self.sources().detach()
                self._mean, self._deviation = inputs.mean(0), inputs.std(0).clamp(min=SMALLEST)
        if self._settings.residual.use:
            alone = self.network is None
            start = self._settings.initial if alone else 0.0
            raw = torch.full((m,), start, device=device) if raw is None else raw
            colour = GREY if alone else 0.0
            rgb = torch.full((m, 3), colour, device=device) if rgb is None else rgb
            self.raw, self.rgb = nn.Parameter(raw.clone()), nn.Parameter(rgb.clone())

    def keep(self, which: Int64[Tensor, "k"]) -> None:
        """From now on be the field at these of the points, in this order."""
        if self.sources is not None:
            self.sources.keep(which)
        if self._settings.residual.use:
            self.raw, self.rgb = nn.Parameter(self.raw[which]), nn.Parameter(self.rgb[which])

    def forward(
        self,
    ) -> tuple[Float32[Tensor, "m"], Float32[Tensor, "m 3"]]:
        """Density, or where there is a relief distance, and colour of every point."""
        raw, rgb = (
            self.network((self.sources() - self._mean) / self._deviation)
            if self.network is not None
            else (0.0, 0.0)
        )
        if self._settings.residual.use:
            raw, rgb = raw + self.raw, rgb + self.rgb
        if self._settings.relief.use:
            return raw * self._unit, rgb.clamp(0, 1)
        readings, ceiling = self._settings.readings, self._settings.ceiling
        return activate(raw, readings.activation, self._unit, ceiling), rgb.clamp(0, 1)

    @torch.no_grad()
    def settle(self) -> None:
        """After a step, bring what points learn by themselves back to where it has a gradient."""
        if self._settings.residual.use and self.network is None:
            self.rgb.clamp_(0, 1)
            if not self._settings.relief.use:
                self.raw.clamp_(EMPTY, self._settings.ceiling)

    def own(self) -> list[nn.Parameter]:
        """What points learn by themselves, a row a point."""
        return [self.raw, self.rgb] if self._settings.residual.use else []

    def groups(self) -> list[dict]:
        """What an optimiser learns, and how fast."""
        ways, own = self._settings.network, self._settings.residual
        learned = [
            {"params": [p for p in self.network_parameters() if p.requires_grad], "lr": ways.rate},
        ]
        if own.use:
            learned += [
                {"params": [self.raw], "lr": own.density_rate},
                {"params": [self.rgb], "lr": own.colour_rate},
            ]
        return [group for group in learned if group["params"]]

    def network_parameters(self) -> list[nn.Parameter]:
        """Those of E and N."""
        modules = [module for module in (self.sources, self.network) if module is not None]
        return [p for module in modules for p in module.parameters()]
