"""Training data and the loss."""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np
import torch
from jaxtyping import Float, Float32
from torch import Tensor, nn

from industnerf.device import device
from industnerf.errors import ReconstructionFailed
from industnerf.learning.targets import surface_points
from industnerf.learning.view_sampler import Batch, ViewSampler
from industnerf.methods.atlasnet.chamfer import chamfer
from industnerf.methods.atlasnet.network import AtlasNet
from industnerf.methods.base import Example
from industnerf.schema import AtlasNetSettings

SURFACE_POOL = 16384  # points of a surface that every step draws its few from


@runtime_checkable
class ImageSource(Protocol):
    """What a network learns from: parts by index."""

    def sample(
        self, net: nn.Module, part_indices: Batch, rng: np.random.Generator
    ) -> tuple[Float[Tensor, "b 3 px px"], Float[Tensor, "b m 3"]]:
        """A random view of each part, and points of its surface in the axes to predict in."""
        ...


class AtlasNetDataset:
    """Photographs and surfaces of all parts, in memory."""

    def __init__(
        self, examples: Sequence[Example], settings: AtlasNetSettings, rng: np.random.Generator
    ) -> None:
        self.target_points, self.device = settings.target_points, device()
        self.view_sampler = ViewSampler.of(examples, settings)
        self.surfaces: Float32[np.ndarray, "parts dense 3"] = np.stack(
            [surface_points(*one.mesh, SURFACE_POOL, rng) for one in examples]
        )

    def sample(
        self, net: nn.Module, part_indices: Batch, rng: np.random.Generator
    ) -> tuple[Float[Tensor, "b 3 px px"], Float[Tensor, "b m 3"]]:
        """A random view of each part, and points of its surface in the axes to predict in."""
        images, rotations = self.view_sampler.sample_images(net, part_indices, rng)
        point_indices = rng.integers(SURFACE_POOL, size=(len(part_indices), self.target_points))
        points = self.surfaces[part_indices[:, None], point_indices] @ rotations.astype(np.float32)
        return images, torch.from_numpy(points).to(self.device)


def image_loss(
    net: AtlasNet,
    source: ImageSource,
    settings: AtlasNetSettings,
    part_indices: Batch,
    rng: np.random.Generator,
) -> Float[Tensor, ""]:
    """Chamfer distance of points predicted from one random view of each part.

    Raises ReconstructionFailed if they are not finite.
    """
    images, target = source.sample(net, part_indices, rng)
    shape = settings.patches, 2, len(target), settings.patch_points
    points = net(images, torch.from_numpy(rng.random(shape, np.float32)).to(target.device))
    if not points.isfinite().all():
        raise ReconstructionFailed(
            "the network predicts points that are not finite: its training diverged; "
            f"method.atlasnet.training.lr is {settings.training.lr}, lower it"
        )
    return chamfer(points, target)
