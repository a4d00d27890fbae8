"""Training data and the loss."""

from collections.abc import Sequence

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from industnerf.errors import ReconstructionFailed
from industnerf.learning.training_shape import TrainingShape
from industnerf.learning.view_sampler import Batch, ViewSampler
from industnerf.methods.atlasnet.chamfer import chamfer
from industnerf.methods.atlasnet.network import AtlasNet
from industnerf.schema import AtlasNetSettings


class AtlasNetDataset:
    """Views and surfaces of all shapes, in memory or mapped from files."""

    def __init__(
        self,
        shapes: Sequence[TrainingShape],
        settings: AtlasNetSettings,
        rng: np.random.Generator,
    ) -> None:
        self.settings = settings
        self.view_sampler = ViewSampler.of(
            shapes, settings.image_px, settings.train_views, settings.augment
        )
        self.surfaces = [shape.surface_pool(rng) for shape in shapes]

    def loss(
        self, net: AtlasNet, part_indices: Batch, rng: np.random.Generator
    ) -> Float[Tensor, ""]:
        """Chamfer distance of points predicted from one random view of each part.

        Raises ReconstructionFailed if they are not finite.
        """
        views = self.view_sampler.random_views(part_indices, rng)
        contrasts, frames = self.view_sampler.contrasts(net, part_indices, views, rng)
        target = torch.from_numpy(self._targets(part_indices, frames, rng)).to(contrasts)
        shape = self.settings.patches, 2, len(target), self.settings.patch_points
        uv = torch.from_numpy(rng.random(shape, np.float32)).to(contrasts.device)
        points = net(contrasts, torch.from_numpy(frames).to(contrasts), uv)
        if not points.isfinite().all():
            raise ReconstructionFailed(
                "the network predicts points that are not finite: its training diverged; "
                f"method.atlasnet.training.lr is {self.settings.training.lr}, lower it"
            )
        return chamfer(points, target)

    def _targets(
        self, part_indices: Batch, frames: Float[np.ndarray, "b 3 3"], rng: np.random.Generator
    ) -> Float[np.ndarray, "b n 3"]:
        """Random points of each surface, in the axes to predict in."""
        count = self.settings.target_points
        surfaces = [self.surfaces[part] for part in part_indices]
        points = np.stack([one[rng.integers(len(one), size=count)] for one in surfaces])
        return points @ frames if self.settings.output_axes == "picture" else points
