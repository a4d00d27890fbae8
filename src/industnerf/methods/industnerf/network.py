"""N of eq. (4): from a point's features and encoding to density and colour.  Reading R4."""

import math
from itertools import pairwise
from typing import assert_never, final

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import softplus

from industnerf.schema.readings import ActivationReading

CUT = math.exp(-6)  # what `cut_exp` takes off: raw values of -6 and less have no density


@final
class Network(nn.Module):
    """A perceptron with `layers` hidden layers of `hidden` units.

    Its last layer starts at zero weights: every point has the raw density `initial` and is
    grey.  The other initial weights come from torch's global generator.
    """

    def __init__(self, inputs: int, hidden: int, layers: int, initial: float) -> None:
        super().__init__()
        widths = [inputs, *[hidden] * layers]
        body: list[nn.Module] = []
        for width, following in pairwise(widths):
            body += [nn.Linear(width, following), nn.ReLU()]
        self.body = nn.Sequential(*body)
        self.head = nn.Linear(widths[-1], 4)
        nn.init.zeros_(self.head.weight)
        nn.init.zeros_(self.head.bias)
        with torch.no_grad():
            self.head.bias[0] = initial

    def forward(
        self, inputs: Float[Tensor, "n i"]
    ) -> tuple[Float[Tensor, "n"], Float[Tensor, "n 3"]]:
        """Raw density, for `activate`, and colour in (0, 1)."""
        raw = self.head(self.body(inputs))
        return raw[:, 0], raw[:, 1:].sigmoid()


def activate(
    raw: Float[Tensor, "*n"], reading: ActivationReading, unit: float, ceiling: float
) -> Float[Tensor, "*n"]:
    """Density in 1/length of raw density; in 1/`unit`, which is a length, before the division.

    cut_exp  max(exp(min(raw, ceiling)) - exp(-6), 0): exactly 0 for raw <= -6.
    relu     max(raw, 0).
    softplus log(1 + exp(raw)): positive everywhere (until it underflows), so that the paper's
             "points with sigma > 0" are all points.

    Where a density is cut, above `ceiling` and at 0, it has no gradient in its own raw value.
    """
    match reading:
        case "cut_exp":
            density = (raw.clamp(max=ceiling).exp() - CUT).clamp(min=0)
        case "relu":
            density = raw.clamp(min=0)
        case "softplus":
            density = softplus(raw)
        case _:
            assert_never(reading)
    return density / unit
