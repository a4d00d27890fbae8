"""The gated recurrent unit, whose hidden state is a grid -- section 3.2 of the paper."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

GRID_SIZE = 4  # a side of the grid
CHANNELS = 128  # of a cell, as published

HiddenGrid = Float[Tensor, "b c 4 4 4"]


class Gate(nn.Module):
    """conv(hidden state) + linear(features of an image) + bias."""

    def __init__(self, features: int, channels: int) -> None:
        super().__init__()
        self.hidden_conv = nn.Conv3d(channels, channels, 3, padding=1)  # its bias is the gate's
        self.input_linear = nn.Linear(features, channels * GRID_SIZE**3, bias=False)

    def forward(self, hidden: HiddenGrid, features: Float[Tensor, "b features"]) -> HiddenGrid:
        return self.hidden_conv(hidden) + self.input_linear(features).view_as(hidden)


class GridGRU(nn.Module):
    """Vectors of several images, one after another, to a grid of 4^3 cells.

    h' = u h + (1 - u) tanh(gate(r h, x)): u = 1 keeps the old state, which starts at 0.
    """

    def __init__(self, features: int, divisor: int) -> None:
        super().__init__()
        self.channels = CHANNELS // divisor
        self.update, self.reset, self.candidate = (Gate(features, self.channels) for _ in range(3))

    def forward(self, features: Float[Tensor, "b views features"]) -> HiddenGrid:
        hidden = features.new_zeros(len(features), self.channels, GRID_SIZE, GRID_SIZE, GRID_SIZE)
        for x in features.unbind(dim=1):
            update = torch.sigmoid(self.update(hidden, x))
            reset = torch.sigmoid(self.reset(hidden, x))
            candidate = torch.tanh(self.candidate(reset * hidden, x))
            hidden = update * hidden + (1 - update) * candidate
        return hidden
