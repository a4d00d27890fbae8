"""What the net is taught: photographs of parts, and which points of space are inside them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32, Int, UInt8
from torch import Tensor
from torch.nn import functional as F

from industnerf.learning.augment import as_tensor, augmented
from industnerf.learning.frames import rolled, turns_of
from industnerf.learning.targets import occupancies
from industnerf.methods.base import Example
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.schema import OccupancySettings


@dataclass(frozen=True)
class Lesson:
    """Views of every part, and points of the enlarged unit cube, each with whether inside."""

    settings: OccupancySettings
    images: list[UInt8[np.ndarray, "_ px px 3"]]
    turns: list[Float[np.ndarray, "_ 3 3"]]  # from the part's axes to the view's, of every image
    points: Float32[np.ndarray, "parts pool 3"]
    inside: Bool[np.ndarray, "parts pool"]

    @staticmethod
    def of(
        examples: Sequence[Example], settings: OccupancySettings, rng: np.random.Generator
    ) -> "Lesson":
        """Read the photographs, and find out which points are inside."""
        images = [example.rgb(settings.image_px, settings.views) for example in examples]
        turns = [turns_of(example.cameras(settings.views), settings.frame) for example in examples]
        pools = [
            occupancies(*example.mesh, settings.pool, settings.padding, rng) for example in examples
        ]
        points, inside = zip(*pools, strict=True)
        return Lesson(settings, images, turns, np.stack(points), np.stack(inside))

    def loss(
        self, net: OccupancyNet, which: Int[np.ndarray, "batch"], rng: np.random.Generator
    ) -> Float[Tensor, ""]:
        """Binary cross entropy, nats: summed over the points, mean over the parts `which`.

        One view of each, and points drawn anew each time; pictures vary only while `net` learns.
        """
        views = [rng.integers(len(self.images[part])) for part in which]
        device = next(net.parameters()).device
        shown = np.stack([self.images[p][v] for p, v in zip(which, views, strict=True)])
        images = as_tensor(shown, device)
        turns = np.stack([self.turns[p][v] for p, v in zip(which, views, strict=True)])
        if net.training:
            images, rolls = augmented(images, self.settings.augment, rng)
            turns = rolled(turns, rolls, self.settings.frame)
        drawn = rng.integers(self.points.shape[1], size=(len(which), self.settings.queries))
        points, inside = self.points[which[:, None], drawn], self.inside[which[:, None], drawn]
        turned = torch.from_numpy((points @ turns).astype(np.float32)).to(device)
        logits = net(images, turned)
        truth = torch.from_numpy(inside).to(logits)
        return F.binary_cross_entropy_with_logits(logits, truth, reduction="sum") / len(which)
