"""N of eq. (4): from a point's features and encoding to density and color.  Reading R4."""

import math
from itertools import pairwise
from typing import assert_never, final

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import softplus
from torch.nn.utils import prune

from industnerf.schema.readings import ActivationReading

COLOR_EPS = 0.02  # colors start this far from 0 and 1, where no gradient leads away
EXP_OFFSET = math.exp(-6)  # what `cut_exp` takes off: raw values of -6 and less have no density


@final
class Network(nn.Module):
    """A perceptron with `layers` hidden layers of `hidden` units, and a straight way past them.

    The straight way learns soon what a single input tells, such as that a view sees background.
    It and the last layer start at zero weights: every point has the raw density `initial` and the
    color that it is given.  The other initial weights come from torch's global generator.  Raw
    densities count `gain` times, for they range farther than outputs of a network easily do.
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
        """The `share` of all weights that are the smallest are 0 from now on; biases stay."""
        layers = [(layer, "weight") for layer in self.modules() if isinstance(layer, nn.Linear)]
        prune.global_unstructured(layers, prune.L1Unstructured, amount=fraction)

    @property
    def num_pruned(self) -> int:
        """How many weights are 0 for good."""
        masks = [mask for name, mask in self.named_buffers() if name.endswith("_mask")]
        return sum(int((mask == 0).sum()) for mask in masks)

    def mlp_parameters(self) -> list[nn.Parameter]:
        """All but those of the straight way."""
        return [*self.body.parameters(), *self.head.parameters()]

    def forward(
        self, inputs: Float[Tensor, "n i"], colors: Float[Tensor, "n 3"]
    ) -> tuple[Float[Tensor, "n"], Float[Tensor, "n 3"]]:
        """N of eq. (4), of pi(F, P, X) and PosE side by side.

        Raw density, for `activate`, and color in (0, 1), which starts at `colors`.
        """
        raw = self.head(self.body(inputs)) + self.skip(inputs)
        return raw[:, 0] * self._density_scale, (raw[:, 1:] + colors.logit(eps=COLOR_EPS)).sigmoid()


def activate(
    raw: Float[Tensor, "*n"], reading: ActivationReading, length_unit: float, max_raw_density: float
) -> Float[Tensor, "*n"]:
    """Density (1/length) of raw density; what follows is in 1/`unit`, a length.

    distance  raw * unit, a signed distance and a length: rendering makes a density of it.
    cut_exp  max(exp(min(raw, ceiling)) - exp(-6), 0): exactly 0 for raw <= -6.
    relu     max(raw, 0).
    softplus log(1 + exp(raw)): positive everywhere (until it underflows), so that the paper's
             "points with sigma > 0" are all points.

    Where a density is cut, above the `ceiling` of cut_exp and at 0, it has no gradient in its own
    raw value.
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
