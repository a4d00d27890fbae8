"""Densities and colours of the cloud points: N of eq. (4), and what each point learns by itself.

    raw, rgb = N(pooled features, PosE) + residual

Without residuals this is the paper's method; without N it is a field of free points.
"""

import torch
from jaxtyping import Float32, Int64
from torch import Tensor, nn

from industnerf.methods.industnerf.levels import spacing_of
from industnerf.methods.industnerf.network import Network, activate
from industnerf.methods.industnerf.roles import view_roles
from industnerf.methods.industnerf.scene import Scene
from industnerf.methods.industnerf.sources import GREY, Sources
from industnerf.schema import IndustnerfSettings

EMPTY = -6.5  # raw density that is nothing, by some margin, and not too far to come back from
SMALLEST = 1e-2  # deviation that an input is raised to 1 from; below, it is told as good as nothing


def moments(
    inputs: Float32[Tensor, "m c"],
) -> tuple[Float32[Tensor, "c"], Float32[Tensor, "c"]]:
    """Mean and deviation of each column."""
    return inputs.detach().mean(0), inputs.detach().std(0).clamp(min=SMALLEST)


class Field(nn.Module):
    """The field at the points that were placed last."""

    def __init__(self, scene: Scene, settings: IndustnerfSettings) -> None:
        super().__init__()
        self._settings = settings
        self._unit = spacing_of(settings.grid_res, 0)  # density is counted per first spacing
        self._telling = view_roles(settings.readings.signal).telling
        self.sources = Sources(scene[self._telling], settings) if settings.network.use else None
        self.softness = 1.0  # of the surface, in first spacings: what N counts distances in
        self._heeding = False  # whether views are trusted more and less yet
        self.register_buffer("_mean", torch.zeros(0))
        self.register_buffer("_deviation", torch.zeros(0))
        self.network = (
            Network(
                self.sources.columns,
                settings.network.hidden,
                settings.network.layers,
                settings.initial,
                settings.network.gain,
            )
            if self.sources is not None
            else None
        )

    def place(
        self,
        points: Float32[Tensor, "m 3"],
        raw: Float32[Tensor, "m"] | None = None,
        rgb: Float32[Tensor, "m 3"] | None = None,
        trust: Float32[Tensor, "v m"] | None = None,
        spacing: float = 0.0,
    ) -> None:
        """From now on be the field at these points; `raw` and `rgb` are residuals to start from.

        Raw density and colour are wholly residual where there is no network.  `trust` is how
        sure each source view was of the points, or None before any has been asked; `spacing` is
        how far apart they are, see `Sources.place`.
        """
        m, device = len(points), points.device
        if self.sources is not None:
            self._place_sources(points, None if trust is None else trust[self._telling], spacing)
        if self._settings.residual.use:
            alone = self.network is None
            start = self._settings.initial if alone else 0.0
            raw = torch.full((m,), start, device=device) if raw is None else raw
            colour = GREY if alone else 0.0
            rgb = torch.full((m, 3), colour, device=device) if rgb is None else rgb
            self.raw, self.rgb = nn.Parameter(raw.clone()), nn.Parameter(rgb.clone())

    def _place_sources(
        self, points: Float32[Tensor, "m 3"], trust: Float32[Tensor, "v m"] | None, spacing: float
    ) -> None:
        """Have N's inputs of these points, counted in deviations as the first grid has them.

        Views that are trusted say something else than all alike, from which N has learned.  When
        they are first heeded, their mean and deviation over the points are made what N is used to.
        """
        self.sources.place(points, spacing)
        mean, deviation = moments(self.sources())
        if not self._mean.numel():
            self._mean, self._deviation = mean, deviation
        if trust is None:
            return
        self.sources.heed(trust)
        if not self._heeding:
            self._heeding = True
            now, spread = moments(self.sources())
            self._mean = now + (self._mean - mean) * spread / deviation
            self._deviation = self._deviation * spread / deviation

    def encode_anew(self) -> None:
        """Have all views told by E as it is now: what N learns of stale ones is soon wrong."""
        if self.sources is not None and self.sources.learns:
            self.sources.encode_anew()

    def keep(self, which: Int64[Tensor, "k"]) -> None:
        """From now on be the field at these of the points, in this order."""
        if self.sources is not None:
            self.sources.keep(which)
        if self._settings.residual.use:
            self.raw, self.rgb = nn.Parameter(self.raw[which]), nn.Parameter(self.rgb[which])

    def forward(
        self,
    ) -> tuple[Float32[Tensor, "m"], Float32[Tensor, "m 3"]]:
        """Density (reading `distance`: signed distance) and colour of every point."""
        raw, rgb = self._told_of() if self.network is not None else (0.0, 0.0)
        if self._settings.residual.use:
            raw, rgb = raw + self.raw, rgb + self.rgb
        readings, ceiling = self._settings.readings, self._settings.ceiling
        return activate(raw, readings.activation, self._unit, ceiling), rgb.clamp(0, 1)

    def _told_of(self) -> tuple[Float32[Tensor, "m"], Float32[Tensor, "m 3"]]:
        """What N makes of the sources."""
        inputs = (self.sources() - self._mean) / self._deviation
        raw, rgb = self.network(inputs, self.sources.colours())
        return raw * self.softness, rgb

    @torch.no_grad()
    def settle(self) -> None:
        """After a step, bring what points learn by themselves back to where it means something."""
        if self._settings.residual.use and self.network is None:
            self.rgb.clamp_(0, 1)
            activation = self._settings.readings.activation
            if activation != "distance":
                # at 0 `relu` still has its gradient; `cut_exp` is 0 from some way above EMPTY
                self.raw.clamp_(0 if activation == "relu" else EMPTY, self._settings.ceiling)

    def numbers(self) -> int:
        """How many numbers are learned: of E, of N, and of the points themselves."""
        learned = sum(p.numel() for p in self.parameters() if p.requires_grad)
        return learned - (self.network.pruned if self.network is not None else 0)

    def own(self) -> list[nn.Parameter]:
        """What points learn by themselves, a row a point."""
        return [self.raw, self.rgb] if self._settings.residual.use else []

    def groups(self) -> list[dict]:
        """What an optimiser learns, and how fast."""
        ways, own = self._settings.network, self._settings.residual
        learned = []
        if self.network is not None:
            learned = [
                {"params": list(self.network.deep_parameters()), "lr": ways.rate},
                {"params": list(self.network.straight.parameters()), "lr": ways.straight_rate},
                {"params": self._encoders(), "lr": ways.encoder_rate},
            ]
        if own.use:
            learned += [
                {"params": [self.raw], "lr": own.density_rate},
                {"params": [self.rgb], "lr": own.colour_rate},
            ]
        return [group for group in learned if group["params"]]

    def _encoders(self) -> list[nn.Parameter]:
        return [p for p in self.sources.parameters() if p.requires_grad]
