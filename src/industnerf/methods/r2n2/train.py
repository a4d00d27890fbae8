"""Training on other shapes: section 3.4 and 4 of the paper, with our images and voxels."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int, UInt8
from torch import Tensor
from torch.nn import functional as F

from industnerf.artifacts.state import ModelState
from industnerf.device import device
from industnerf.learning.fit import fit_network
from industnerf.learning.training_shape import Prior, TrainingShape
from industnerf.learning.view_sampler import ViewSampler
from industnerf.methods.r2n2.network import R2N2, new_net
from industnerf.schema import R2n2Settings
from industnerf.torch_kernels import use_reproducible_kernels

FEWER_VIEWS_SHARE = 0.3  # share of the batches with a random number of views; others have all


def fit_net(
    examples: Sequence[TrainingShape],
    settings: R2n2Settings,
    seed: int,
    scratch: Path,
    prior: Prior,
) -> ModelState:
    """The weights that were best on the validation parts; resumes from `scratch`."""
    use_reproducible_kernels()  # folds are what runs side by side
    net = new_net(settings.image_px, settings.channel_divisor, seed).to(device())
    dataset = R2N2Dataset.of([*examples, *prior.solids], settings, net)
    return fit_network(
        net,
        dataset.loss,
        examples,
        prior,
        settings.training,
        seed,
        scratch / "checkpoint.pt",
        settings.size,
    )


@dataclass(frozen=True)
class R2N2Dataset:
    """Images and voxels of all training shapes."""

    net: R2N2
    view_sampler: ViewSampler
    filled: list[UInt8[np.ndarray, "n n n"]]
    max_views: int

    @staticmethod
    def of(shapes: Sequence[TrainingShape], settings: R2n2Settings, net: R2N2) -> "R2N2Dataset":
        """Read the images of `shapes`, and measure how full their voxels are."""
        views = ViewSampler.of(shapes, settings.image_px, settings.max_views, settings.augment)
        filled = [shape.filled_shares() for shape in shapes]
        return R2N2Dataset(net, views, filled, settings.max_views)

    def loss(
        self, part_indices: Int[np.ndarray, "batch"], rng: np.random.Generator
    ) -> Float[Tensor, ""]:
        """Cross-entropy with the filled share of a voxel, nats, mean over voxels.

        A batch sees the first so many views in nested order, those that a new part is predicted
        from: in training now and then fewer than `max_views`.
        """
        views = min(self.max_views, *(len(self.view_sampler.images[part]) for part in part_indices))
        if self.net.training and rng.random() < FEWER_VIEWS_SHARE:
            views = int(rng.integers(1, views + 1))
        contrasts = [
            self.view_sampler.contrasts(self.net, part_indices, len(part_indices) * [view], rng)[0]
            for view in range(views)
        ]
        filled = np.stack([self.filled[part] for part in part_indices])
        target = torch.from_numpy(filled).to(device()).float() / 255
        empty, full = self.net(torch.stack(contrasts, dim=1)).unbind(dim=1)
        return F.binary_cross_entropy_with_logits(full - empty, target)
