"""ResNet-18 -- He et al., "Deep Residual Learning for Image Recognition" (2016), table 1.

Its weights start at random: pretrained ones cannot be had offline, so no table may use them.
"""

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F


class ResidualBlock(nn.Module):
    """Two 3x3 convolutions, and a way round them."""

    def __init__(self, in_channels: int, out_channels: int, stride: int) -> None:
        super().__init__()
        self.conv1 = nn.Conv2d(in_channels, out_channels, 3, stride, 1, bias=False)
        self.bn1 = nn.BatchNorm2d(out_channels)
        self.conv2 = nn.Conv2d(out_channels, out_channels, 3, 1, 1, bias=False)
        self.bn2 = nn.BatchNorm2d(out_channels)
        self.shortcut = nn.Sequential()
        if stride != 1 or in_channels != out_channels:
            self.shortcut = nn.Sequential(
                nn.Conv2d(in_channels, out_channels, 1, stride, bias=False),
                nn.BatchNorm2d(out_channels),
            )

    def forward(self, x: Float[Tensor, "b c h w"]) -> Float[Tensor, "b d i j"]:
        y = self.bn2(self.conv2(F.relu(self.bn1(self.conv1(x)))))
        return F.relu(y + self.shortcut(x))


class ResNet18(nn.Sequential):
    """Images (b, 3, h, w) to features (b, `features`); as published with `width` 64."""

    def __init__(self, features: int, width: int = 64) -> None:
        widths = [width, 2 * width, 4 * width, 8 * width]
        blocks, in_channels = [], width
        for stage, out_channels in enumerate(widths):
            blocks += [
                ResidualBlock(in_channels, out_channels, 1 if stage == 0 else 2),
                ResidualBlock(out_channels, out_channels, 1),
            ]
            in_channels = out_channels
        super().__init__(
            nn.Conv2d(3, width, 7, 2, 3, bias=False),
            nn.BatchNorm2d(width),
            nn.ReLU(),
            nn.MaxPool2d(3, 2, 1),
            *blocks,
            nn.AdaptiveAvgPool2d(1),
            nn.Flatten(),
            nn.Linear(in_channels, features),
        )
