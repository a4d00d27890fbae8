"""The memory: a gated recurrent unit whose state is a grid -- section 3.2 of the paper."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

CELLS = 4  # a side of the grid
CHANNELS = 128  # of a cell, as published

Grid = Float[Tensor, "b c 4 4 4"]


class Gate(nn.Module):
    """What the memory and a picture say together: conv(memory) + linear(picture) + bias."""

    def __init__(self, features: int, channels: int) -> None:
        super().__init__()
        self.of_memory = nn.Conv3d(channels, channels, 3, padding=1)  # its bias is the gate's
        self.of_picture = nn.Linear(features, channels * CELLS**3, bias=False)

    def forward(self, memory: Grid, picture: Float[Tensor, "b features"]) -> Grid:
        return self.of_memory(memory) + self.of_picture(picture).view_as(memory)


class GridGRU(nn.Module):
    """Vectors of several pictures, one after another, to a grid of 4^3 cells.

    h' = u h + (1 - u) tanh(gate(r h, x)): u = 1 keeps the old memory, which starts at 0.
    """

    def __init__(self, features: int, divisor: int) -> None:
        super().__init__()
        self.channels = CHANNELS // divisor
        self.update, self.reset, self.candidate = (Gate(features, self.channels) for _ in range(3))

    def forward(self, pictures: Float[Tensor, "b views features"]) -> Grid:
        memory = pictures.new_zeros(len(pictures), self.channels, CELLS, CELLS, CELLS)
        for picture in pictures.unbind(dim=1):
            update = torch.sigmoid(self.update(memory, picture))
            reset = torch.sigmoid(self.reset(memory, picture))
            new = torch.tanh(self.candidate(reset * memory, picture))
            memory = update * memory + (1 - update) * new
        return memory
