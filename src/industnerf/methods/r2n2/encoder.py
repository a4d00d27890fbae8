"""From an image to a vector: six stages of two convolutions each, and a linear layer.

Channels, shortcuts and pools as in the authors' `models/res_gru_net.py`.
"""

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F

CHANNELS = (96, 128, 256, 256, 256, 256)  # of the stages, as published
FEATURES = 1024  # of the vector, as published
SLOPE = 0.01  # of the leaky rectifiers


def pooled_size(px: int, times: int = len(CHANNELS)) -> int:
    """How many of `px` pixels a side are left after so many pools: 127, 64, 33, 17, 9, 5, 3."""
    for _ in range(times):
        px = px // 2 + 1
    return px


class ConvBlock(nn.Module):
    """Two convolutions, a shortcut round them or none, and a pool from n to n // 2 + 1 pixels.

    The shortcut is added behind the second rectifier, which is unusual, but as published.
    """

    def __init__(
        self, in_channels: int, out_channels: int, kernel: int, shortcut: nn.Module | None
    ) -> None:
        super().__init__()
        self.conv_a = nn.Conv2d(in_channels, out_channels, kernel, padding="same")
        self.conv_b = nn.Conv2d(out_channels, out_channels, 3, padding="same")
        self.shortcut = shortcut

    def forward(self, x: Float[Tensor, "b c n n"]) -> Float[Tensor, "b d m m"]:
        y = F.leaky_relu(self.conv_b(F.leaky_relu(self.conv_a(x), SLOPE)), SLOPE)
        if self.shortcut is not None:
            y = y + self.shortcut(x)
        return F.max_pool2d(y, 2, padding=1)


class Encoder(nn.Sequential):
    """Images (b, 3, px, px) to vectors (b, 1024 / divisor)."""

    def __init__(self, px: int, divisor: int) -> None:
        a, b, c, d, e, f = (channels // divisor for channels in CHANNELS)
        super().__init__(
            ConvBlock(3, a, 7, None),
            ConvBlock(a, b, 3, nn.Conv2d(a, b, 1)),
            ConvBlock(b, c, 3, nn.Conv2d(b, c, 1)),
            ConvBlock(c, d, 3, None),
            ConvBlock(d, e, 3, nn.Conv2d(d, e, 1)),
            ConvBlock(e, f, 3, nn.Identity()),
            nn.Flatten(),
            nn.Linear(f * pooled_size(px) ** 2, FEATURES // divisor),
            nn.LeakyReLU(SLOPE),
        )
