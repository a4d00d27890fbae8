"""Section 3.1, N of eq. (4): from features and encoding to density and color.  Reading R4."""

import math
from itertools import pairwise
from typing import assert_never, final

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import softplus
from torch.nn.utils import prune

from industnerf.schema.readings import ActivationReading

COLOR_EPS = 0.02  # initial colors keep this far from 0 and 1, where the gradient vanishes
EXP_OFFSET = math.exp(-6)  # of `truncated_exp`: raw values of -6 and less have no density


@final
class Network(nn.Module):
    """An MLP with `hidden_layers` layers of `hidden_dim` units, and a linear skip connection.

    The skip connection soon learns what a single input tells, such as that a view sees background.
    It and the last layer start at zero weights: every point starts with raw density
    `density_bias` and the color that it is given.  The other initial weights come from torch's
    global generator.  Raw density is the output times `density_scale`, because it ranges farther
    than outputs of an MLP easily do.
    """

    def __init__(
        self,
        in_channels: int,
        hidden_dim: int,
        hidden_layers: int,
        density_bias: float,
        density_scale: float,
    ) -> None:
        super().__init__()
        widths = [in_channels, *[hidden_dim] * hidden_layers]
        layers: list[nn.Module] = []
        for width, next_width in pairwise(widths):
            layers += [nn.Linear(width, next_width), nn.ReLU()]
        self.body = nn.Sequential(*layers)
        self.head = nn.Linear(widths[-1], 4)
        self.skip = nn.Linear(in_channels, 4, bias=False)
        nn.init.zeros_(self.skip.weight)
        nn.init.zeros_(self.head.weight)
        nn.init.zeros_(self.head.bias)
        with torch.no_grad():
            self.head.bias[0] = density_bias / density_scale
        self._density_scale = density_scale

    def prune(self, fraction: float) -> None:
        """Set this fraction of all weights, the smallest, to 0 for good; biases stay."""
        layers = [(layer, "weight") for layer in self.modules() if isinstance(layer, nn.Linear)]
        prune.global_unstructured(layers, prune.L1Unstructured, amount=fraction)

    @property
    def num_pruned(self) -> int:
        """Number of pruned weights."""
        masks = [mask for name, mask in self.named_buffers() if name.endswith("_mask")]
        return sum(int((mask == 0).sum()) for mask in masks)

    def mlp_parameters(self) -> list[nn.Parameter]:
        """All parameters but those of the skip connection."""
        return [*self.body.parameters(), *self.head.parameters()]

    def forward(
        self, inputs: Float[Tensor, "n i"], colors: Float[Tensor, "n 3"]
    ) -> tuple[Float[Tensor, "n"], Float[Tensor, "n 3"]]:
        """N of eq. (4): raw density, for `activate`, and color in (0, 1).

        `inputs` are pi(F, P, X) and PosE side by side; the color starts at `colors`.
        """
        raw = self.head(self.body(inputs)) + self.skip(inputs)
        return raw[:, 0] * self._density_scale, (raw[:, 1:] + colors.logit(eps=COLOR_EPS)).sigmoid()


def activate(
    raw: Float[Tensor, "*n"], reading: ActivationReading, length_unit: float, max_raw_density: float
) -> Float[Tensor, "*n"]:
    """Density in 1/length, of raw density in 1/`length_unit`.  Reading R4.

    sdf            raw * length_unit: a signed distance, which the renderer turns into a density.
    truncated_exp  max(exp(min(raw, max_raw_density)) - exp(-6), 0): exactly 0 for raw <= -6.
    relu           max(raw, 0).
    softplus       log(1 + exp(raw)): positive everywhere (until it underflows), so the paper's
                   "points with sigma > 0" are all points.

    Where a density is clamped it has no gradient in its own raw value.
    """
    match reading:
        case "sdf":
            return raw * length_unit
        case "truncated_exp":
            density = (raw.clamp(max=max_raw_density).exp() - EXP_OFFSET).clamp(min=0)
        case "relu":
            density = raw.clamp(min=0)
        case "softplus":
            density = softplus(raw)
        case _:
            assert_never(reading)
    return density / length_unit
