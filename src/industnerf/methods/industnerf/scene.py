"""The input of section 3.1: views and camera poses (I, P), in the unit frame.

In the unit frame the region of interest is the unit ball.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import assert_never

import numpy as np
import torch
from jaxtyping import Float, Float32, Int64, UInt8
from torch import Tensor
from torch.nn.functional import normalize

from industnerf.geometry.cameras import Cameras
from industnerf.rendering.render import Rays
from industnerf.schema.readings import TargetViewsReading


@dataclass(frozen=True)
class PosedImages:
    """Images and cameras as the user gives them, in any unit."""

    rgb: UInt8[np.ndarray, "n h w 3"]
    cameras: Cameras
    background: Float[np.ndarray, "n 3"] | None  # in [0, 1]; None: estimated from the images
    center: Float[np.ndarray, "3"]  # of the region of interest
    radius: float
    depth: Float32[np.ndarray, "n h w"] | None = None  # along the axis; 0: no reading

    def to_world(self, points: Float[np.ndarray, "m 3"]) -> Float32[np.ndarray, "m 3"]:
        """Points of the unit frame in that of the cameras."""
        return (points * self.radius + self.center).astype(np.float32)


@dataclass(frozen=True)
class TorchCameras:
    """`n` cameras in the unit frame."""

    K: Float32[Tensor, "n 3 3"]
    c2w: Float32[Tensor, "n 4 4"]
    width: int
    height: int

    def __len__(self) -> int:
        return len(self.K)

    def __getitem__(self, index: Tensor | slice) -> "TorchCameras":
        return TorchCameras(self.K[index], self.c2w[index], self.width, self.height)

    @cached_property
    def _pixel_to_ray(self) -> Float32[Tensor, "n 3 3"]:
        """From homogeneous pixel coordinates to ray directions."""
        return self.c2w[:, :3, :3] @ torch.linalg.inv(self.K)

    def rays(
        self,
        view: Int64[Tensor, "r"],
        uv: Float32[Tensor, "r 2"],
        offsets: Float32[Tensor, "r"],
    ) -> Rays:
        """Rays through the pixel coordinates `uv` (px) of the views `view`."""
        homogeneous = torch.cat([uv, torch.ones_like(uv[:, :1])], dim=1)
        directions = normalize(
            torch.einsum("rij,rj->ri", self._pixel_to_ray[view], homogeneous), dim=1
        )
        return Rays(self.c2w[view, :3, 3].contiguous(), directions, offsets)


def torch_cameras(
    cameras: Cameras, center: np.ndarray, radius: float, device: torch.device
) -> TorchCameras:
    """`cameras` in the frame where the ball round `center` is the unit ball."""
    c2w = cameras.c2w.copy()
    c2w[:, :3, 3] = (c2w[:, :3, 3] - center) / radius
    K, c2w = (torch.tensor(x, dtype=torch.float32, device=device) for x in (cameras.K, c2w))
    return TorchCameras(K, c2w, cameras.width, cameras.height)


@dataclass(frozen=True)
class NerfScene:
    """The images, their cameras, and the color behind the part, view by view."""

    images: UInt8[Tensor, "n h w 3"]
    cameras: TorchCameras
    background: Float32[Tensor, "n 3"]
    depth: Float32[Tensor, "n h w"] | None = None  # along the axis; 0: no reading

    def __len__(self) -> int:
        return len(self.images)

    def __getitem__(self, index: Tensor | slice) -> "NerfScene":
        depth = None if self.depth is None else self.depth[index]
        return NerfScene(self.images[index], self.cameras[index], self.background[index], depth)


def make_scene(posed: PosedImages, device: torch.device) -> NerfScene:
    """`posed` in the unit frame, its background estimated where none is given."""
    images = torch.from_numpy(np.ascontiguousarray(posed.rgb)).to(device)
    cameras = torch_cameras(posed.cameras, posed.center, posed.radius, device)
    if posed.background is None:
        background = estimate_background(images)
    else:
        background = torch.tensor(posed.background, dtype=torch.float32, device=device)
    depth = None
    if posed.depth is not None:
        depth = torch.from_numpy(posed.depth / posed.radius).float().to(device)
    return NerfScene(images, cameras, background, depth)


def estimate_background(images: UInt8[Tensor, "n h w 3"]) -> Float32[Tensor, "n 3"]:
    """Median color of the border pixels of each image, in [0, 1].

    The paper does not say what is behind the part.  All of the part is in frame, so the border of
    an image shows the background.
    """
    sides = [images[:, 0], images[:, -1], images[:, :, 0], images[:, :, -1]]
    return torch.cat(sides, dim=1).float().median(dim=1).values / 255


@dataclass(frozen=True)
class SourceTargetSplit:
    """Which views are source views and which are target views, as slices of all."""

    source: slice  # N sees their features
    target: slice  # their pixels are the training signal


def source_target_split(reading: TargetViewsReading) -> SourceTargetSplit:
    """Reading R10.

    same_as_source: every view is both.  disjoint: every other view is a target, the rest sources.
    """
    match reading:
        case "same_as_source":
            return SourceTargetSplit(slice(None), slice(None))
        case "disjoint":
            return SourceTargetSplit(slice(0, None, 2), slice(1, None, 2))
        case _:
            assert_never(reading)
