"""From the hidden grid's 4^3 cells to 32^3 voxels: three times unpool and convolve.

Channels and shortcuts as in the authors' `models/res_gru_net.py`.
"""

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F

from industnerf.methods.r2n2 import gru
from industnerf.methods.r2n2.encoder import SLOPE

CHANNELS = (128, 128, 64, 32)  # at 8^3, 16^3, 32^3 and once more at 32^3, as published
CLASSES = 2  # empty, full

VoxelFeatures = Float[Tensor, "b c n n n"]


def unpool(x: VoxelFeatures) -> Float[Tensor, "b c m m m"]:
    """Twice as many cells a side: each value in the even corner of eight, the others 0."""
    b, c, n, _, _ = x.shape
    wide = x.new_zeros(b, c, 2 * n, 2 * n, 2 * n)
    wide[:, :, ::2, ::2, ::2] = x
    return wide


def conv_unpooled(conv: nn.Conv3d, x: VoxelFeatures) -> Float[Tensor, "b d m m m"]:
    """`conv(unpool(x))` of a kernel of 3, without its products with 0, seven of eight."""
    weight = conv.weight.transpose(0, 1).flip(2, 3, 4)
    return F.conv_transpose3d(x, weight, conv.bias, stride=2, padding=1, output_padding=1)


def shortcut_unpooled(shortcut: nn.Module, x: VoxelFeatures) -> Float[Tensor, "b d m m m"]:
    """`shortcut(unpool(x))` of a kernel of 1 or of none, without its products with 0."""
    if isinstance(shortcut, nn.Identity):
        return unpool(x)
    return unpool(F.conv3d(x, shortcut.weight)) + shortcut.bias.view(-1, 1, 1, 1)


def conv3(in_channels: int, out_channels: int) -> nn.Conv3d:
    return nn.Conv3d(in_channels, out_channels, 3, padding=1)


class UpsampleBlock(nn.Module):
    """Unpool, and two convolutions with a shortcut round them."""

    def __init__(self, in_channels: int, out_channels: int, shortcut: nn.Module) -> None:
        super().__init__()
        self.conv_a = conv3(in_channels, out_channels)
        self.conv_b = conv3(out_channels, out_channels)
        self.shortcut = shortcut

    def forward(self, x: VoxelFeatures) -> Float[Tensor, "b d m m m"]:
        y = F.leaky_relu(conv_unpooled(self.conv_a, x), SLOPE)
        return F.leaky_relu(self.conv_b(y), SLOPE) + shortcut_unpooled(self.shortcut, x)


class OutputBlock(nn.Module):
    """Two convolutions; the shortcut is a third, and leads round the second alone."""

    def __init__(self, in_channels: int, out_channels: int) -> None:
        super().__init__()
        self.conv_a = conv3(in_channels, out_channels)
        self.conv_b = conv3(out_channels, out_channels)
        self.shortcut = conv3(out_channels, out_channels)

    def forward(self, x: VoxelFeatures) -> Float[Tensor, "b d n n n"]:
        y = F.leaky_relu(self.conv_a(x), SLOPE)
        return F.leaky_relu(self.conv_b(y), SLOPE) + self.shortcut(y)


class Decoder(nn.Sequential):
    """Hidden grids (b, 128 / divisor, 4, 4, 4) to scores of two classes (b, 2, 32, 32, 32)."""

    def __init__(self, divisor: int) -> None:
        a, b, c, d = (channels // divisor for channels in CHANNELS)
        super().__init__(
            UpsampleBlock(gru.CHANNELS // divisor, a, nn.Identity()),
            UpsampleBlock(a, b, nn.Identity()),
            UpsampleBlock(b, c, nn.Conv3d(b, c, 1)),
            OutputBlock(c, d),
            conv3(d, CLASSES),
        )
