"""Training data: views of shapes, and points of space with their occupancy."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float, Float32
from torch import Tensor
from torch.nn import functional as F

from industnerf.learning.targets import OccupancyPool
from industnerf.learning.training_shape import TrainingShape
from industnerf.learning.view_sampler import Batch, ViewSampler
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.schema import OccupancySettings
from industnerf.schema.training import QueryAxes


def decoder_points(
    points: Float[np.ndarray, "b n 3"], frames: Float[np.ndarray, "b 3 3"], axes: QueryAxes
) -> Float32[np.ndarray, "b n dims"]:
    """Points of the unit cube as the decoder takes them, given the frames of the pictures."""
    in_picture = points @ frames
    chosen = {"part": [points], "picture": [in_picture], "both": [in_picture, points]}[axes]
    return np.concatenate(chosen, axis=2).astype(np.float32)


@dataclass(frozen=True)
class OccupancyDataset:
    """Views of every shape, and points of the padded unit cube, each with whether inside."""

    view_sampler: ViewSampler
    pools: list[OccupancyPool]
    num_queries: int  # of the points, every time
    axes: QueryAxes

    @staticmethod
    def of(
        shapes: Sequence[TrainingShape], settings: OccupancySettings, rng: np.random.Generator
    ) -> "OccupancyDataset":
        """Read the views, and sample points and their occupancy."""
        return OccupancyDataset(
            ViewSampler.of(shapes, settings.image_px, settings.train_views, settings.augment),
            [shape.occupancy_pool(settings.points_per_part, rng) for shape in shapes],
            settings.points_subsample,
            settings.query_axes,
        )

    def loss(
        self, net: OccupancyNet, part_indices: Batch, rng: np.random.Generator
    ) -> Float[Tensor, ""]:
        """Binary cross entropy, nats, mean over the padded cube and over the parts.

        One view of each, and points drawn anew each time: from strata, and weighted by their
        shares of the cube, so that the mean is what uniform points would give.
        """
        views = self.view_sampler.random_views(part_indices, rng)
        contrasts, frames = self.view_sampler.contrasts(net, part_indices, views, rng)
        drawn = [self.pools[part].draw(self.num_queries, rng) for part in part_indices]
        points, inside, weights = (np.stack(one) for one in zip(*drawn, strict=True))
        logits = net(
            contrasts, torch.from_numpy(decoder_points(points, frames, self.axes)).to(contrasts)
        )
        target, weight = (torch.from_numpy(one).to(logits) for one in (inside, weights))
        return F.binary_cross_entropy_with_logits(logits, target, weight)
