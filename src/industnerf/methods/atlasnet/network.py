"""AtlasNet's decoder, and the encoder of points that it is first trained with.

As in the authors' second code, which differs from the paper: all of a patch's layers but the first
have one width, and nothing bounds where its points may be.
"""

import math

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F
from torch.nn.modules.batchnorm import _BatchNorm

from industnerf.learning.resnet import ResNet18
from industnerf.schema import AtlasNetSettings

POINT_WIDTHS = (64, 128)  # of the first layers of PointNet


class PatchLinear(nn.Module):
    """A linear layer for each patch, all at once, initialized as `nn.Linear` is."""

    def __init__(self, patches: int, in_features: int, out_features: int) -> None:
        super().__init__()
        bound = 1 / math.sqrt(in_features)
        self.weight = nn.Parameter(
            torch.empty(patches, out_features, in_features).uniform_(-bound, bound)
        )
        self.bias = nn.Parameter(torch.empty(patches * out_features).uniform_(-bound, bound))

    def forward(self, x: Float[Tensor, "patches before n"]) -> Float[Tensor, "patches after n"]:
        return torch.baddbmm(self.bias.view(*self.weight.shape[:2], 1), self.weight, x)


class PatchNorm(nn.BatchNorm1d):
    """Batch norm of every channel of every patch, then ReLU."""

    def __init__(self, patches: int, channels: int) -> None:
        super().__init__(patches * channels)

    def forward(self, x: Float[Tensor, "patches c n"]) -> Float[Tensor, "patches c n"]:
        return F.relu(super().forward(x.reshape(1, -1, x.shape[2])).view(x.shape))


class Decoder(nn.Module):
    """From a latent to points: each patch maps its unit square into space."""

    def __init__(self, patches: int, latent: int, hidden: int) -> None:
        super().__init__()
        self.patches = patches
        self.first = PatchLinear(patches, 2, latent)
        layers: list[nn.Module] = [PatchNorm(patches, latent)]
        for in_features in (latent, hidden, hidden):
            layers += [PatchLinear(patches, in_features, hidden), PatchNorm(patches, hidden)]
        self.rest = nn.Sequential(*layers, PatchLinear(patches, hidden, 3))

    def forward(
        self, latent: Float[Tensor, "b latent"], uv: Float[Tensor, "patches 2 b n"]
    ) -> Float[Tensor, "b patches_n 3"]:
        """The points at `uv`, patch by patch; the latent is one more bias of the first layer."""
        batch, count = uv.shape[2:]
        x = self.first(uv.flatten(2)).unflatten(2, (batch, count)) + latent.T[:, :, None]
        points = self.rest(x.flatten(2)).unflatten(2, (batch, count))
        return points.permute(2, 0, 3, 1).flatten(1, 2)


class PointNet(nn.Module):
    """Points (b, n, 3), in any order, to a latent (b, c) -- Qi et al. (2017)."""

    def __init__(self, latent: int) -> None:
        super().__init__()
        one, two = POINT_WIDTHS
        self.points = nn.Sequential(
            *(nn.Conv1d(3, one, 1), nn.BatchNorm1d(one), nn.ReLU()),
            *(nn.Conv1d(one, two, 1), nn.BatchNorm1d(two), nn.ReLU()),
            *(nn.Conv1d(two, latent, 1), nn.BatchNorm1d(latent)),
        )
        self.cloud = nn.Sequential(
            *(nn.Linear(latent, latent), nn.BatchNorm1d(latent), nn.ReLU()),
            *(nn.Linear(latent, latent), nn.BatchNorm1d(latent), nn.ReLU()),
        )

    def forward(self, points: Float[Tensor, "b n 3"]) -> Float[Tensor, "b latent"]:
        return self.cloud(self.points(points.transpose(1, 2)).amax(dim=2))


class AtlasNet(nn.Module):
    """An encoder, of points or of images, and the decoder that both share."""

    def __init__(self, encoder: nn.Module, decoder: Decoder) -> None:
        super().__init__()
        self.encoder, self.decoder = encoder, decoder
        self.has_frozen_batch_norm = False  # batch norms keep their statistics in training

    def train(self, mode: bool = True) -> "AtlasNet":
        """For training or for evaluation; frozen batch norms are always for evaluation.

        Wu and Johnson, "Rethinking 'Batch' in BatchNorm" (2021), freeze them in the last epochs.
        """
        super().train(mode)
        for module in self.modules():
            if self.has_frozen_batch_norm and isinstance(module, _BatchNorm):
                module.eval()
        return self

    def forward(
        self, inputs: Float[Tensor, "b ..."], uv: Float[Tensor, "patches 2 b n"]
    ) -> Float[Tensor, "b patches_n 3"]:
        return self.decoder(self.encoder(inputs), uv)


def build_decoder(settings: AtlasNetSettings) -> Decoder:
    """A new decoder."""
    return Decoder(settings.patches, settings.latent_dim, settings.hidden_dim)


def build_image_encoder(settings: AtlasNetSettings) -> ResNet18:
    """A new encoder of images."""
    return ResNet18(settings.latent_dim, settings.encoder_width)
