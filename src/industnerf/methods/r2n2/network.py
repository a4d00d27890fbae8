"""The whole network: ResidualGRUNet of the authors' code."""

import math

import torch
from jaxtyping import Float
from torch import Tensor, nn

from industnerf.learning.augment import INPUT_GAIN
from industnerf.learning.weights import torch_seed
from industnerf.methods.r2n2.decoder import Decoder
from industnerf.methods.r2n2.encoder import FEATURES, Encoder
from industnerf.methods.r2n2.gru import GridGRU

INITIAL_BIAS = 0.1


class R2N2(nn.Module):
    """Contrasts to the background to scores of empty and full; as published with 127 px, divisor 1.

    All channels but those of the images and the two classes are divided by `divisor`.
    """

    def __init__(self, px: int, divisor: int) -> None:
        super().__init__()
        self.encoder = Encoder(px, divisor)
        self.gru = GridGRU(FEATURES // divisor, divisor)
        self.decoder = Decoder(divisor)
        self.apply(initialize)

    def forward(self, contrasts: Float[Tensor, "b views 3 px px"]) -> Float[Tensor, "b 2 32 32 32"]:
        # channels last: so few channels at so many places take a CPU half the time
        flat = (INPUT_GAIN * contrasts).flatten(0, 1).contiguous(memory_format=torch.channels_last)
        hidden = self.gru(self.encoder(flat).view(*contrasts.shape[:2], -1))
        return self.decoder(hidden.contiguous(memory_format=torch.channels_last_3d))

    @torch.no_grad()
    def occupancy_probability(
        self, contrasts: Float[Tensor, "b views 3 px px"]
    ) -> Float[Tensor, "b 32 32 32"]:
        """The probability of each voxel to be full."""
        return self(contrasts).softmax(dim=1)[:, 1]


def initialize(module: nn.Module) -> None:
    """Normal weights of variance 2 / mean(fan in, fan out), and constant biases."""
    if isinstance(module, nn.Conv2d | nn.Conv3d | nn.Linear):
        nn.init.xavier_normal_(module.weight, gain=math.sqrt(2))
        if module.bias is not None:
            nn.init.constant_(module.bias, INITIAL_BIAS)


def new_net(px: int, divisor: int, seed: int) -> R2N2:
    """A network whose weights depend on `seed` alone."""
    with torch_seed(seed):
        return R2N2(px, divisor)
