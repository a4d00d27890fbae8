"""Training on other parts: section 3.4 and 4 of the paper, with our images and voxels."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Bool, Float, Int, UInt8
from torch import Tensor
from torch.nn import functional as F

from industnerf.artifacts.state import ModelState
from industnerf.device import device
from industnerf.learning.augment import augment, images_to_tensor
from industnerf.learning.targets import voxelize
from industnerf.learning.training import model_state, train, train_val_split
from industnerf.methods.base import Example
from industnerf.methods.r2n2.decoder import VOXELS
from industnerf.methods.r2n2.network import R2N2, new_net
from industnerf.schema import R2n2Settings
from industnerf.seeds import generator
from industnerf.torch_kernels import use_reproducible_kernels


def fit_net(
    examples: Sequence[Example], settings: R2n2Settings, seed: int, scratch: Path
) -> ModelState:
    """The weights that were best on the validation parts; resumes from `scratch`."""
    use_reproducible_kernels()  # folds are what runs side by side
    net = new_net(settings.image_px, settings.channel_divisor, seed).to(device())
    dataset = R2N2Dataset.of(examples, settings, net, seed)
    split = train_val_split(examples, settings.training.val_fraction)
    result = train(net, dataset.loss, split, settings.training, seed, scratch / "checkpoint.pt")
    return model_state(net, result, len(split[0]), settings.size)


@dataclass(frozen=True)
class R2N2Dataset:
    """Images and voxels of all training parts."""

    net: R2N2
    settings: R2n2Settings
    images: UInt8[np.ndarray, "parts views px px 3"]
    occupied: Bool[np.ndarray, "parts n n n"]

    @staticmethod
    def of(
        examples: Sequence[Example], settings: R2n2Settings, net: R2N2, seed: int
    ) -> "R2N2Dataset":
        """Read the images of `examples`, and voxelize their meshes."""
        rng = generator(seed, "lessons")
        images = [one.rgb(settings.image_px, settings.train_views) for one in examples]
        occupied = [voxelize(*one.mesh, VOXELS, rng) for one in examples]
        return R2N2Dataset(net, settings, np.stack(images), np.stack(occupied))

    def loss(
        self, part_indices: Int[np.ndarray, "batch"], rng: np.random.Generator
    ) -> Float[Tensor, ""]:
        """Cross-entropy of empty and full, mean over voxels, as many views for the whole batch.

        Views are drawn one by one from those of the part, so that one may come twice; one to
        `max_views` of them in training, `max_views`, as in the end, in validation.
        """
        max_views = self.settings.max_views
        views = rng.integers(1, max_views + 1) if self.net.training else max_views
        view_indices = rng.integers(self.images.shape[1], size=(len(part_indices), views))
        sampled = self.images[part_indices[:, None], view_indices]
        images = images_to_tensor(sampled.reshape(-1, *sampled.shape[2:]), device())
        if self.net.training:
            images, _ = augment(images, self.settings.augment, rng)
        target = torch.from_numpy(self.occupied[part_indices].astype(np.int64)).to(device())
        return F.cross_entropy(
            self.net(images.view(*view_indices.shape, *images.shape[1:])), target
        )
