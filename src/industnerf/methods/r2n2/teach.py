"""Training on other parts: section 3.4 and 4 of the paper, with our pictures and voxels."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Bool, Float, Int, UInt8
from torch import Tensor
from torch.nn import functional as F

from industnerf.artifacts.state import State
from industnerf.device import device
from industnerf.learning.augment import as_tensor, augmented
from industnerf.learning.targets import voxels
from industnerf.learning.training import set_apart, state_of, train
from industnerf.methods.base import Example
from industnerf.methods.r2n2.decoder import VOXELS
from industnerf.methods.r2n2.net import R2N2, new_net
from industnerf.schema import R2n2Settings
from industnerf.seeds import generator


def trained(examples: Sequence[Example], settings: R2n2Settings, seed: int, scratch: Path) -> State:
    """The weights that were best on the parts set apart; goes on from `scratch`."""
    torch.set_num_threads(1)  # folds are what runs side by side
    net = new_net(settings.image_px, settings.divisor, seed).to(device())
    lessons = Lessons.of(examples, settings, net, seed)
    names = [example.part_id for example in examples]
    parts = set_apart(names, settings.training.validation)
    how = train(net, lessons.loss, parts, settings.training, seed, scratch / "checkpoint.pt")
    return state_of(net, how, len(parts[0]), settings.size)


@dataclass(frozen=True)
class Lessons:
    """Pictures and voxels of all parts to learn from."""

    net: R2N2
    settings: R2n2Settings
    pictures: UInt8[np.ndarray, "parts views px px 3"]
    full: Bool[np.ndarray, "parts n n n"]

    @staticmethod
    def of(examples: Sequence[Example], settings: R2n2Settings, net: R2N2, seed: int) -> "Lessons":
        """Read the pictures of `examples`, and make voxels of their meshes."""
        rng = generator(seed, "lessons")
        pictures = [one.rgb(settings.image_px, settings.pictures) for one in examples]
        full = [voxels(*one.mesh, VOXELS, rng) for one in examples]
        return Lessons(net, settings, np.stack(pictures), np.stack(full))

    def loss(self, which: Int[np.ndarray, "batch"], rng: np.random.Generator) -> Float[Tensor, ""]:
        """Cross-entropy of empty and full, mean over voxels, as many views for the whole batch.

        Views are drawn one by one from those of the part, so that one may come twice; one to
        `views` of them while the net learns, as many as it will be asked by to choose its weights.
        """
        most = self.settings.views
        views = rng.integers(1, most + 1) if self.net.training else most
        drawn = rng.integers(self.pictures.shape[1], size=(len(which), views))
        shown = self.pictures[which[:, None], drawn]
        images = as_tensor(shown.reshape(-1, *shown.shape[2:]), device())
        if self.net.training:
            images, _ = augmented(images, self.settings.augment, rng)
        truth = torch.from_numpy(self.full[which].astype(np.int64)).to(device())
        return F.cross_entropy(self.net(images.view(*drawn.shape, *images.shape[1:])), truth)
