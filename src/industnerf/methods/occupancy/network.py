"""The network: images to codes, a code and points to logits of being inside.

The published decoder with conditional batch norm -- Mescheder et al. (2019), supplement 1.1.
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F

from industnerf.learning.augment import INPUT_GAIN
from industnerf.learning.resnet import ResNet18
from industnerf.schema import OccupancySettings

POINT_DIMS = {"part": 3, "picture": 3, "both": 6}  # numbers of a point, by `query_axes`


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

    def __init__(self, code: int, width: int, blocks: int, point_dims: int = 3) -> None:
        super().__init__()
        self.first = nn.Linear(point_dims, width)
        self.blocks = nn.ModuleList(Block(code, width) for _ in range(blocks))
        self.norm, self.last = ConditionalNorm(code, width), nn.Linear(width, 1)

    def forward(
        self, points: Float[Tensor, "b n dims"], code: Float[Tensor, "b code"]
    ) -> Float[Tensor, "b n"]:
        x = self.first(points)
        for block in self.blocks:
            x = block(x, code)
        return self.last(F.relu(self.norm(x, code)))[..., 0]


class OccupancyNet(nn.Module):
    """As published with the settings of `experiment=gpu` and points in the part's axes."""

    def __init__(self, settings: OccupancySettings) -> None:
        super().__init__()
        self.encoder = ResNet18(settings.latent_dim, settings.encoder_width)
        self.decoder = Decoder(
            settings.latent_dim,
            settings.decoder_width,
            settings.decoder_blocks,
            POINT_DIMS[settings.query_axes],
        )

    def encode(self, contrasts: Float[Tensor, "b 3 px px"]) -> Float[Tensor, "b code"]:
        """The code of each image, given as its contrast to the background."""
        return self.encoder(INPUT_GAIN * contrasts)

    def forward(
        self, contrasts: Float[Tensor, "b 3 px px"], points: Float[Tensor, "b n dims"]
    ) -> Float[Tensor, "b n"]:
        return self.decoder(points, self.encode(contrasts))
