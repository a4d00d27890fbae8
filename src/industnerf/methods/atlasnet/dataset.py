"""Training data and losses of both trainings: of points, and of images."""

from collections.abc import Sequence

import numpy as np
import torch
from jaxtyping import Float, Float32
from torch import Tensor

from industnerf.device import device
from industnerf.errors import ReconstructionFailed
from industnerf.learning.targets import surface_points
from industnerf.learning.view_sampler import Batch, ViewSampler
from industnerf.methods.atlasnet.chamfer import chamfer
from industnerf.methods.atlasnet.network import AtlasNet
from industnerf.methods.base import Example
from industnerf.schema import AtlasNetSettings

SURFACE_POOL = 16384  # points of a surface that every step draws its few from


class AtlasNetDataset:
    """Photographs and surfaces of all parts, in memory."""

    def __init__(
        self, examples: Sequence[Example], settings: AtlasNetSettings, rng: np.random.Generator
    ) -> None:
        self.settings, self.device = settings, device()
        self.view_sampler = ViewSampler.of(examples, settings)
        self.surfaces: Float32[np.ndarray, "parts dense 3"] = np.stack(
            [surface_points(*one.mesh, SURFACE_POOL, rng) for one in examples]
        )

    def autoencoder_loss(
        self, net: AtlasNet, part_indices: Batch, rng: np.random.Generator
    ) -> Float[Tensor, ""]:
        """Loss of the auto-encoder: to reproduce its input points."""
        rotations = self.view_sampler.rotations_of(
            part_indices, self.view_sampler.sample_views(part_indices, rng)
        )
        points = self._points(part_indices, rotations, rng)
        return self._loss(net, points, points, rng)

    def image_loss(
        self, net: AtlasNet, part_indices: Batch, rng: np.random.Generator
    ) -> Float[Tensor, ""]:
        """Loss of points predicted from one random view of each part."""
        images, rotations = self.view_sampler.sample_images(net, part_indices, rng)
        return self._loss(net, images, self._points(part_indices, rotations, rng), rng)

    def _points(
        self, part_indices: Batch, rotations: Float[np.ndarray, "b 3 3"], rng: np.random.Generator
    ) -> Float[Tensor, "b n 3"]:
        count = self.settings.patches * self.settings.patch_points
        point_indices = rng.integers(SURFACE_POOL, size=(len(part_indices), count))
        points = self.surfaces[part_indices[:, None], point_indices] @ rotations.astype(np.float32)
        return torch.from_numpy(points).to(self.device)

    def _loss(
        self,
        net: AtlasNet,
        inputs: Float[Tensor, "b ..."],
        target: Float[Tensor, "b n 3"],
        rng: np.random.Generator,
    ) -> Float[Tensor, ""]:
        shape = self.settings.patches, 2, len(target), self.settings.patch_points
        points = net(inputs, torch.from_numpy(rng.random(shape, np.float32)).to(self.device))
        if not points.isfinite().all():
            raise ReconstructionFailed(
                "the net gives points that are not finite: its training diverged; "
                f"method.atlasnet.training.lr is {self.settings.training.lr}, lower it"
            )
        return chamfer(points, target)
