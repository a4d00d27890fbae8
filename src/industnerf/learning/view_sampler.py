"""What nets of one view are shown: one photograph of each part, another one every time."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
import torch
from jaxtyping import Float, Int, UInt8
from torch import Tensor, nn

from industnerf.geometry.cameras import Cameras
from industnerf.learning.augment import augment, images_to_tensor
from industnerf.learning.axis_alignment import apply_camera_roll, axis_rotations
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
    """Views of every part, in memory, and how each is turned."""

    images: list[UInt8[np.ndarray, "_ px px 3"]]
    rotations: list[Float[np.ndarray, "_ 3 3"]]  # from the part's axes to those of the answer
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
        """A view of each of the parts `which`, at random."""
        return [int(rng.integers(len(self.images[part]))) for part in part_indices]

    def rotations_of(self, part_indices: Batch, views: list[int]) -> Float[np.ndarray, "b 3 3"]:
        """Of points p of the parts, p @ turn are in the axes that the net answers in."""
        return np.stack(
            [self.rotations[part][view] for part, view in zip(part_indices, views, strict=True)]
        )

    def sample_images(
        self, net: nn.Module, part_indices: Batch, rng: np.random.Generator
    ) -> tuple[Float[Tensor, "b 3 px px"], Float[np.ndarray, "b 3 3"]]:
        """A picture of each part, on the device of `net`, and its axes.

        Pictures vary only while `net` learns.
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
