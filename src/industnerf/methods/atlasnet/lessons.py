"""What is shown to the nets, and the loss of what they make of it."""

from collections.abc import Sequence

import numpy as np
import torch
from jaxtyping import Float, Float32
from torch import Tensor

from industnerf.device import device
from industnerf.errors import ReconstructionFailed
from industnerf.learning.glances import Batch, Glances
from industnerf.learning.targets import surface_points
from industnerf.methods.atlasnet.chamfer import chamfer
from industnerf.methods.atlasnet.network import AtlasNet
from industnerf.methods.base import Example
from industnerf.schema import AtlasNetSettings

DENSE = 16384  # points of a surface that every step draws its few from


class Lessons:
    """Photographs and surfaces of all parts, in memory."""

    def __init__(
        self, examples: Sequence[Example], settings: AtlasNetSettings, rng: np.random.Generator
    ) -> None:
        self.settings, self.device = settings, device()
        self.glances = Glances.of(examples, settings)
        self.surfaces: Float32[np.ndarray, "parts dense 3"] = np.stack(
            [surface_points(*one.mesh, DENSE, rng) for one in examples]
        )

    def from_points(
        self, net: AtlasNet, which: Batch, rng: np.random.Generator
    ) -> Float[Tensor, ""]:
        """Loss of the auto-encoder: to give back the points that it is shown."""
        turns = self.glances.axes(which, self.glances.drawn(which, rng))
        points = self._points(which, turns, rng)
        return self._loss(net, points, points, rng)

    def from_pictures(
        self, net: AtlasNet, which: Batch, rng: np.random.Generator
    ) -> Float[Tensor, ""]:
        """Loss of points guessed from one view of each part, drawn at random."""
        seen, turns = self.glances.shown(net, which, rng)
        return self._loss(net, seen, self._points(which, turns, rng), rng)

    def _points(
        self, which: Batch, turns: Float[np.ndarray, "b 3 3"], rng: np.random.Generator
    ) -> Float[Tensor, "b n 3"]:
        count = self.settings.patches * self.settings.patch_points
        drawn = rng.integers(DENSE, size=(len(which), count))
        points = self.surfaces[which[:, None], drawn] @ turns.astype(np.float32)
        return torch.from_numpy(points).to(self.device)

    def _loss(
        self,
        net: AtlasNet,
        seen: Float[Tensor, "b ..."],
        truth: Float[Tensor, "b n 3"],
        rng: np.random.Generator,
    ) -> Float[Tensor, ""]:
        shape = self.settings.patches, 2, len(truth), self.settings.patch_points
        points = net(seen, torch.from_numpy(rng.random(shape, np.float32)).to(self.device))
        if not points.isfinite().all():
            raise ReconstructionFailed(
                "the net gives points that are not finite: its training diverged; "
                f"method.atlasnet.training.rate is {self.settings.training.rate}, lower it"
            )
        return chamfer(points, truth)
