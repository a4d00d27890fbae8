"""The posed images in a frame of their own: the region of interest is the unit ball."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from jaxtyping import Float, Float32, Int64, UInt8
from torch import Tensor
from torch.nn.functional import normalize

from industnerf.geometry.cameras import Cameras
from industnerf.rendering.render import Rays


@dataclass(frozen=True)
class PosedImages:
    """What the method works on, in any unit."""

    rgb: UInt8[np.ndarray, "n h w 3"]
    cameras: Cameras
    background: Float[np.ndarray, "n 3"] | None  # in [0, 1]; None: estimated from the images
    center: Float[np.ndarray, "3"]  # of the region of interest
    radius: float
    depth: Float32[np.ndarray, "n h w"] | None = None  # along the axis; 0: no reading


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
        """From homogeneous pixel coordinates to directions: found once, for every step asks."""
        return self.c2w[:, :3, :3] @ torch.linalg.inv(self.K)

    def rays(
        self,
        view: Int64[Tensor, "r"],
        uv: Float32[Tensor, "r 2"],
        offsets: Float32[Tensor, "r"],
    ) -> Rays:
        """Through the pixel coordinates `uv` (px) of the views `view`."""
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
    """`posed` in the unit frame; a background that is not given is the median of the borders."""
    images = torch.from_numpy(np.ascontiguousarray(posed.rgb)).to(device)
    given_background = posed.background
    background = (
        estimate_background(images)
        if given_background is None
        else torch.tensor(given_background, dtype=torch.float32, device=device)
    )
    cameras = torch_cameras(posed.cameras, posed.center, posed.radius, device)
    depth = None if posed.depth is None else torch.from_numpy(posed.depth / posed.radius)
    return NerfScene(
        images, cameras, background, None if depth is None else depth.float().to(device)
    )


def estimate_background(images: UInt8[Tensor, "n h w 3"]) -> Float32[Tensor, "n 3"]:
    """The median color of each image's outermost pixels.

    The paper does not say what is behind the part.  A source image shows it at its border, for
    all of the part is in frame: this is taken from the images alone.
    """
    sides = [images[:, 0], images[:, -1], images[:, :, 0], images[:, :, -1]]
    return torch.cat(sides, dim=1).float().median(dim=1).values / 255
