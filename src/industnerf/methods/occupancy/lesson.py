"""What the net is taught: photographs of parts, and which points of space are inside them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32
from torch import Tensor
from torch.nn import functional as F

from industnerf.learning.glances import Batch, Glances
from industnerf.learning.targets import occupancies
from industnerf.methods.base import Example
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.schema import OccupancySettings


@dataclass(frozen=True)
class Lesson:
    """Views of every part, and points of the enlarged unit cube, each with whether inside."""

    glances: Glances
    points: Float32[np.ndarray, "parts pool 3"]
    inside: Bool[np.ndarray, "parts pool"]
    queries: int  # of the points, every time

    @staticmethod
    def of(
        examples: Sequence[Example], settings: OccupancySettings, rng: np.random.Generator
    ) -> "Lesson":
        """Read the photographs, and find out which points are inside."""
        pools = [
            occupancies(*example.mesh, settings.pool, settings.padding, rng) for example in examples
        ]
        points, inside = zip(*pools, strict=True)
        glances = Glances.of(examples, settings)
        return Lesson(glances, np.stack(points), np.stack(inside), settings.queries)

    def loss(self, net: OccupancyNet, which: Batch, rng: np.random.Generator) -> Float[Tensor, ""]:
        """Binary cross entropy, nats: summed over the points, mean over the parts `which`.

        One view of each, and points drawn anew each time.
        """
        images, turns = self.glances.shown(net, which, rng)
        drawn = rng.integers(self.points.shape[1], size=(len(which), self.queries))
        points, inside = self.points[which[:, None], drawn], self.inside[which[:, None], drawn]
        turned = torch.from_numpy((points @ turns).astype(np.float32)).to(images.device)
        logits = net(images, turned)
        truth = torch.from_numpy(inside).to(logits)
        return F.binary_cross_entropy_with_logits(logits, truth, reduction="sum") / len(which)
