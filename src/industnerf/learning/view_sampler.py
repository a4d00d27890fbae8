"""Training inputs of networks: views of each part, augmented, and the axes of their pictures."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int, UInt8
from torch import Tensor, nn

from industnerf.learning.augment import augment, contrast_to_background
from industnerf.learning.training_shape import TrainingShape
from industnerf.schema import AugmentSettings

Batch = Int[np.ndarray, "b"]


@dataclass(frozen=True)
class ViewSampler:
    """The first views of every part's nested order, in memory or mapped from a file."""

    images: list[UInt8[np.ndarray, "_ px px 3"]]
    backgrounds: list[Float[np.ndarray, "_ 3"]]
    frames: list[Float[np.ndarray, "_ 3 3"]]  # `industnerf.learning.views.picture_frames`
    augment: AugmentSettings

    @staticmethod
    def of(
        shapes: Sequence[TrainingShape], px: int, views: int, augment: AugmentSettings
    ) -> "ViewSampler":
        """Read at most `views` views of `px` a side of each of `shapes`."""
        return ViewSampler(
            [shape.rgb(px, views) for shape in shapes],
            [shape.background(views) for shape in shapes],
            [shape.picture_frames(views) for shape in shapes],
            augment,
        )

    def random_views(self, part_indices: Batch, rng: np.random.Generator) -> list[int]:
        """One view of each of the parts."""
        return [int(rng.integers(len(self.images[part]))) for part in part_indices]

    def contrasts(
        self, net: nn.Module, part_indices: Batch, views: Sequence[int], rng: np.random.Generator
    ) -> tuple[Float[Tensor, "b 3 px px"], Float[np.ndarray, "b 3 3"]]:
        """View number `views[i]` of part i, on the device of `net`, and the axes of the picture.

        They are augmented only while `net` is in training mode.
        """
        pairs = list(zip(part_indices, views, strict=True))
        contrasts = contrast_to_background(
            np.stack([self.images[part][view] for part, view in pairs]),
            np.stack([self.backgrounds[part][view] for part, view in pairs]),
            next(net.parameters()).device,
        )
        frames = np.stack([self.frames[part][view] for part, view in pairs])
        if net.training:
            contrasts, changes = augment(contrasts, self.augment, rng)
            frames = frames @ changes
        return contrasts, frames
