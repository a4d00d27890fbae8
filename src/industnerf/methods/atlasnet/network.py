"""AtlasNet: an encoder of images, and the decoder that maps patches into space.

As in the authors' second code, which differs from the paper: all of a patch's layers but the first
have one width, and nothing bounds where its points may be.  Different from both: patches start
apart, the decoder has no batch norm, and no auto-encoder comes first.
"""

import math

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F

from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.learning.augment import INPUT_GAIN
from industnerf.learning.resnet import ResNet18
from industnerf.schema import AtlasNetSettings

START_RADIUS = 0.3  # of the sphere on which patches start; the axes' unit is the size of the part
START_SCALE = 0.1  # of the last layer's weights, so that most patches start at their places


class PatchLinear(nn.Module):
    """A linear layer for each patch, all at once, initialized for ReLU -- He et al. (2015)."""

    def __init__(self, patches: int, in_features: int, out_features: int) -> None:
        super().__init__()
        bound = math.sqrt(6 / in_features)
        self.weight = nn.Parameter(
            torch.empty(patches, out_features, in_features).uniform_(-bound, bound)
        )
        self.bias = nn.Parameter(torch.zeros(patches * out_features))

    def forward(self, x: Float[Tensor, "patches before n"]) -> Float[Tensor, "patches after n"]:
        return torch.baddbmm(self.bias.view(*self.weight.shape[:2], 1), self.weight, x)


class Decoder(nn.Module):
    """From a latent to points: each patch maps its unit square into space.

    Patches start small and spread over a sphere.  Where all start at the origin they overlap, and
    no loss of nearest points parts them again.  Batch norm would add noise and a third of the time.
    """

    def __init__(self, patches: int, latent: int, hidden: int) -> None:
        super().__init__()
        self.patches = patches
        self.first = PatchLinear(patches, 2, latent)
        self.hidden = nn.ModuleList(
            PatchLinear(patches, in_features, hidden) for in_features in (latent, hidden, hidden)
        )
        self.last = PatchLinear(patches, hidden, 3)
        centers = START_RADIUS * fibonacci_sphere(patches)
        with torch.no_grad():
            self.last.weight *= START_SCALE
            self.last.bias.copy_(torch.from_numpy(centers.astype(np.float32)).flatten())

    def forward(
        self, latent: Float[Tensor, "b latent"], uv: Float[Tensor, "patches 2 b n"]
    ) -> Float[Tensor, "b patches_n 3"]:
        """The points at `uv`, patch by patch; the latent is one more bias of the first layer."""
        batch, count = uv.shape[2:]
        centered = 2 * uv.flatten(2) - 1
        x = self.first(centered).unflatten(2, (batch, count)) + latent.T[:, :, None]
        x = F.relu(x).flatten(2)
        for layer in self.hidden:
            x = F.relu(layer(x))
        points = self.last(x).unflatten(2, (batch, count))
        return points.permute(2, 0, 3, 1).flatten(1, 2)


class AtlasNet(nn.Module):
    """An encoder of images, one of the axes of the picture, and the decoder.

    The camera is known, and parts are made along their axes: told these, the network need not
    guess them from the image.
    """

    def __init__(self, encoder: nn.Module, latent: int, decoder: Decoder) -> None:
        super().__init__()
        self.encoder, self.decoder = encoder, decoder
        self.frame_encoder = nn.Sequential(
            nn.Flatten(), nn.Linear(9, latent), nn.ReLU(), nn.Linear(latent, latent)
        )

    def forward(
        self,
        contrasts: Float[Tensor, "b 3 px px"],
        frames: Float[Tensor, "b 3 3"],
        uv: Float[Tensor, "patches 2 b n"],
    ) -> Float[Tensor, "b patches_n 3"]:
        latent = self.encoder(INPUT_GAIN * contrasts) + self.frame_encoder(frames)
        return self.decoder(latent, uv)


def build_network(settings: AtlasNetSettings) -> AtlasNet:
    """A new network."""
    return AtlasNet(
        ResNet18(settings.latent_dim, settings.encoder_width),
        settings.latent_dim,
        Decoder(settings.patches, settings.latent_dim, settings.hidden_dim),
    )
