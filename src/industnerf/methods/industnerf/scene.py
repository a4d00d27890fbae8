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
class Posed:
    """What the method works on, in any unit."""

    rgb: UInt8[np.ndarray, "n h w 3"]
    cameras: Cameras
    background: Float[np.ndarray, "n 3"] | None  # in [0, 1]; None: estimated from the images
    centre: Float[np.ndarray, "3"]  # of the region of interest
    radius: float
    depth: Float32[np.ndarray, "n h w"] | None = None  # along the axis; 0: no reading


@dataclass(frozen=True)
class Eyes:
    """`n` cameras in the unit frame."""

    K: Float32[Tensor, "n 3 3"]
    c2w: Float32[Tensor, "n 4 4"]
    width: int
    height: int

    def __len__(self) -> int:
        return len(self.K)

    def __getitem__(self, which: Tensor | slice) -> "Eyes":
        return Eyes(self.K[which], self.c2w[which], self.width, self.height)

    @cached_property
    def _towards(self) -> Float32[Tensor, "n 3 3"]:
        """From homogeneous pixel coordinates to directions: found once, for every step asks."""
        return self.c2w[:, :3, :3] @ torch.linalg.inv(self.K)

    def rays(
        self,
        view: Int64[Tensor, "r"],
        uv: Float32[Tensor, "r 2"],
        offsets: Float32[Tensor, "r"],
    ) -> Rays:
        """Through the pixel coordinates `uv` (px) of the views `view`."""
        whole = torch.cat([uv, torch.ones_like(uv[:, :1])], dim=1)
        directions = normalize(torch.einsum("rij,rj->ri", self._towards[view], whole), dim=1)
        return Rays(self.c2w[view, :3, 3].contiguous(), directions, offsets)


def eyes(cameras: Cameras, centre: np.ndarray, radius: float, device: torch.device) -> Eyes:
    """`cameras` in the frame where the ball round `centre` is the unit ball."""
    c2w = cameras.c2w.copy()
    c2w[:, :3, 3] = (c2w[:, :3, 3] - centre) / radius
    K, c2w = (torch.tensor(x, dtype=torch.float32, device=device) for x in (cameras.K, c2w))
    return Eyes(K, c2w, cameras.width, cameras.height)


@dataclass(frozen=True)
class Scene:
    """The images, their cameras, and the colour behind the part, view by view."""

    images: UInt8[Tensor, "n h w 3"]
    eyes: Eyes
    background: Float32[Tensor, "n 3"]
    depth: Float32[Tensor, "n h w"] | None = None  # along the axis; 0: no reading

    def __len__(self) -> int:
        return len(self.images)

    def __getitem__(self, which: Tensor | slice) -> "Scene":
        depth = None if self.depth is None else self.depth[which]
        return Scene(self.images[which], self.eyes[which], self.background[which], depth)


def scene_of(posed: Posed, device: torch.device) -> Scene:
    """`posed` in the unit frame; a background that is not given is the median of the borders."""
    images = torch.from_numpy(np.ascontiguousarray(posed.rgb)).to(device)
    known = posed.background
    background = (
        border_colour(images)
        if known is None
        else torch.tensor(known, dtype=torch.float32, device=device)
    )
    seen = eyes(posed.cameras, posed.centre, posed.radius, device)
    depth = None if posed.depth is None else torch.from_numpy(posed.depth / posed.radius)
    return Scene(images, seen, background, None if depth is None else depth.float().to(device))


def border_colour(images: UInt8[Tensor, "n h w 3"]) -> Float32[Tensor, "n 3"]:
    """The median colour of each image's outermost pixels.

    The paper does not say what is behind the part.  A source image shows it at its border, for
    all of the part is in frame: this is taken from the images alone.
    """
    sides = [images[:, 0], images[:, -1], images[:, :, 0], images[:, :, -1]]
    return torch.cat(sides, dim=1).float().median(dim=1).values / 255
