"""Training inputs of single-view networks: a random view of each part, augmented."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
import torch
from jaxtyping import Float, Int, UInt8
from torch import Tensor, nn

from industnerf.geometry.cameras import Cameras
from industnerf.learning.augment import augment, images_to_tensor
from industnerf.learning.views import apply_camera_roll, axis_rotations
from industnerf.schema import AtlasNetSettings, AugmentSettings, OccupancySettings
from industnerf.schema.training import OutputAxes

Batch = Int[np.ndarray, "b"]


@runtime_checkable
class ImageExample(Protocol):
    """A part to learn from, as `industnerf.methods.base.Example` is."""

    def rgb(self, px: int, count: int) -> UInt8[np.ndarray, "views {px} {px} 3"]: ...

    def cameras(self, count: int) -> Cameras: ...


@dataclass(frozen=True)
class ViewSampler:
    """Views of every part, in memory, and the rotation of each."""

    images: list[UInt8[np.ndarray, "_ px px 3"]]
    rotations: list[Float[np.ndarray, "_ 3 3"]]  # from the part's axes to the output axes
    augment: AugmentSettings
    axes: OutputAxes

    @staticmethod
    def of(
        examples: Sequence[ImageExample], settings: AtlasNetSettings | OccupancySettings
    ) -> "ViewSampler":
        """Read the photographs."""
        return ViewSampler(
            [one.rgb(settings.image_px, settings.train_views) for one in examples],
            [
                axis_rotations(one.cameras(settings.train_views), settings.output_axes)
                for one in examples
            ],
            settings.augment,
            settings.output_axes,
        )

    def sample_views(self, part_indices: Batch, rng: np.random.Generator) -> list[int]:
        """A random view of each of the parts."""
        return [int(rng.integers(len(self.images[part]))) for part in part_indices]

    def rotations_of(self, part_indices: Batch, views: list[int]) -> Float[np.ndarray, "b 3 3"]:
        """A rotation R a part: of its points p, p @ R are in the network's output axes."""
        return np.stack(
            [self.rotations[part][view] for part, view in zip(part_indices, views, strict=True)]
        )

    def sample_images(
        self, net: nn.Module, part_indices: Batch, rng: np.random.Generator
    ) -> tuple[Float[Tensor, "b 3 px px"], Float[np.ndarray, "b 3 3"]]:
        """A view of each part, on the device of `net`, and its rotation.

        Images are augmented only while `net` is in training mode.
        """
        views = self.sample_views(part_indices, rng)
        images = np.stack([self.images[p][v] for p, v in zip(part_indices, views, strict=True)])
        tensors = images_to_tensor(images, _device(net))
        rotations = self.rotations_of(part_indices, views)
        if net.training:
            tensors, rolls = augment(tensors, self.augment, rng)
            rotations = apply_camera_roll(rotations, rolls, self.axes)
        return tensors, rotations


def _device(net: nn.Module) -> torch.device:
    return next(net.parameters()).device
