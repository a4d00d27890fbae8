"""The network: images to codes, a code and points to logits of being inside.

The published decoder with conditional batch norm -- Mescheder et al. (2019), supplement 1.1.
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F

from industnerf.learning.resnet import ResNet18
from industnerf.schema import OccupancySettings

# of ImageNet, r g b; the published encoder takes its images relative to these
MEAN, STD = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)


class ConditionalNorm(nn.Module):
    """Batch norm over all points of all images; the code of an image scales and shifts its own.

    Every code starts by scaling by 1 and shifting by 0 -- de Vries et al. (2017).
    """

    def __init__(self, code: int, width: int) -> None:
        super().__init__()
        self.norm = nn.BatchNorm1d(width, affine=False)
        self.scale, self.shift = nn.Linear(code, width), nn.Linear(code, width)
        for linear, start in ((self.scale, 1.0), (self.shift, 0.0)):
            nn.init.zeros_(linear.weight)
            nn.init.constant_(linear.bias, start)

    def forward(
        self, x: Float[Tensor, "b n width"], code: Float[Tensor, "b code"]
    ) -> Float[Tensor, "b n width"]:
        normed = self.norm(x.flatten(0, 1)).view_as(x)
        return torch.addcmul(self.shift(code)[:, None], normed, self.scale(code)[:, None])


class Block(nn.Module):
    """Twice norm, ReLU and a layer, and a way round them; it starts as the identity and a bias."""

    def __init__(self, code: int, width: int) -> None:
        super().__init__()
        self.norm1, self.norm2 = ConditionalNorm(code, width), ConditionalNorm(code, width)
        self.layer1, self.layer2 = nn.Linear(width, width), nn.Linear(width, width)
        nn.init.zeros_(self.layer2.weight)

    def forward(
        self, x: Float[Tensor, "b n width"], code: Float[Tensor, "b code"]
    ) -> Float[Tensor, "b n width"]:
        y = self.layer1(F.relu(self.norm1(x, code)))
        return x + self.layer2(F.relu(self.norm2(y, code)))


class Decoder(nn.Module):
    """Logits of being inside, point by point."""

    def __init__(self, code: int, width: int, blocks: int) -> None:
        super().__init__()
        self.first = nn.Linear(3, width)
        self.blocks = nn.ModuleList(Block(code, width) for _ in range(blocks))
        self.norm, self.last = ConditionalNorm(code, width), nn.Linear(width, 1)

    def forward(
        self, points: Float[Tensor, "b n 3"], code: Float[Tensor, "b code"]
    ) -> Float[Tensor, "b n"]:
        x = self.first(points)
        for block in self.blocks:
            x = block(x, code)
        return self.last(F.relu(self.norm(x, code)))[..., 0]


class OccupancyNet(nn.Module):
    """As published with the settings of `experiment=gpu`."""

    def __init__(self, settings: OccupancySettings) -> None:
        super().__init__()
        self.encoder = ResNet18(settings.latent_dim, settings.encoder_width)
        self.decoder = Decoder(settings.latent_dim, settings.decoder_width, settings.decoder_blocks)

    def encode(self, images: Float[Tensor, "b 3 px px"]) -> Float[Tensor, "b code"]:
        """The code of each image, whose values are in [0, 1]."""
        mean, std = (images.new_tensor(x).view(3, 1, 1) for x in (MEAN, STD))
        return self.encoder((images - mean) / std)

    def forward(
        self, images: Float[Tensor, "b 3 px px"], points: Float[Tensor, "b n 3"]
    ) -> Float[Tensor, "b n"]:
        return self.decoder(points, self.encode(images))
