"""What the net is taught: photographs of parts, and which points of space are inside them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32, Int, UInt8
from torch import Tensor
from torch.nn import functional as F

from industnerf.learning.augment import as_tensor, augmented
from industnerf.learning.targets import occupancies
from industnerf.methods.base import Example
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.schema import OccupancySettings


@dataclass(frozen=True)
class Lesson:
    """Views of every part, and points of the enlarged unit cube, each with whether inside."""

    settings: OccupancySettings
    images: list[UInt8[np.ndarray, "_ px px 3"]]
    points: Float32[np.ndarray, "parts pool 3"]
    inside: Bool[np.ndarray, "parts pool"]

    @staticmethod
    def of(
        examples: Sequence[Example], settings: OccupancySettings, rng: np.random.Generator
    ) -> "Lesson":
        """Read the photographs, and find out which points are inside."""
        images = [example.rgb(settings.image_px, settings.views) for example in examples]
        pools = [
            occupancies(*example.mesh, settings.pool, settings.padding, rng) for example in examples
        ]
        points, inside = zip(*pools, strict=True)
        return Lesson(settings, images, np.stack(points), np.stack(inside))

    def loss(
        self, net: OccupancyNet, which: Int[np.ndarray, "batch"], rng: np.random.Generator
    ) -> Float[Tensor, ""]:
        """Binary cross entropy, nats: summed over the points, mean over the parts `which`.

        One view of each, and points drawn anew each time; pictures vary only while `net` learns.
        """
        views = [self.images[part][rng.integers(len(self.images[part]))] for part in which]
        images = as_tensor(np.stack(views))
        if net.training:
            images = augmented(images, self.settings.augment, rng)
        drawn = rng.integers(self.points.shape[1], size=(len(which), self.settings.queries))
        points, inside = self.points[which[:, None], drawn], self.inside[which[:, None], drawn]
        device = next(net.parameters()).device
        logits = net(images.to(device), torch.from_numpy(points).to(device))
        truth = torch.from_numpy(inside).to(logits)
        return F.binary_cross_entropy_with_logits(logits, truth, reduction="sum") / len(which)
