"""Training data: photographs of parts, and points of space with their occupancy."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32
from torch import Tensor
from torch.nn import functional as F

from industnerf.learning.targets import sample_occupancy
from industnerf.learning.view_sampler import Batch, ViewSampler
from industnerf.methods.base import Example
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.schema import OccupancySettings


@dataclass(frozen=True)
class OccupancyDataset:
    """Views of every part, and points of the enlarged unit cube, each with whether inside."""

    view_sampler: ViewSampler
    points: Float32[np.ndarray, "parts pool 3"]
    inside: Bool[np.ndarray, "parts pool"]
    num_queries: int  # of the points, every time

    @staticmethod
    def of(
        examples: Sequence[Example], settings: OccupancySettings, rng: np.random.Generator
    ) -> "OccupancyDataset":
        """Read the photographs, and sample points and their occupancy."""
        pools = [
            sample_occupancy(*example.mesh, settings.points_per_part, settings.padding, rng)
            for example in examples
        ]
        points, inside = zip(*pools, strict=True)
        view_sampler = ViewSampler.of(examples, settings)
        return OccupancyDataset(
            view_sampler, np.stack(points), np.stack(inside), settings.points_subsample
        )

    def loss(
        self, net: OccupancyNet, part_indices: Batch, rng: np.random.Generator
    ) -> Float[Tensor, ""]:
        """Binary cross entropy, nats: summed over the points, mean over the parts.

        One view of each, and points drawn anew each time.
        """
        images, rotations = self.view_sampler.sample_images(net, part_indices, rng)
        point_indices = rng.integers(
            self.points.shape[1], size=(len(part_indices), self.num_queries)
        )
        points = self.points[part_indices[:, None], point_indices]
        inside = self.inside[part_indices[:, None], point_indices]
        rotated = torch.from_numpy((points @ rotations).astype(np.float32)).to(images.device)
        logits = net(images, rotated)
        target = torch.from_numpy(inside).to(logits)
        return F.binary_cross_entropy_with_logits(logits, target, reduction="sum") / len(
            part_indices
        )
