"""Section 3.3, target views: the rays R = R(P) through their pixels, and the pixels' colors.

Reading R10: re-rendering the views is the only training signal.
"""

from copy import copy
from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float32, Int64
from torch import Tensor
from torch.nn.functional import adaptive_avg_pool2d, adaptive_max_pool2d, max_pool2d

from industnerf.geometry.cameras import reduced_size
from industnerf.methods.industnerf.projection import project
from industnerf.methods.industnerf.scene import NerfScene, TorchCameras, source_target_split
from industnerf.rendering.render import Rays
from industnerf.schema.readings import TargetViewsReading

DEPTH_EDGE = 0.02  # unit lengths: depths within a pixel that differ more are of an edge


@dataclass(frozen=True)
class RayBatch:
    """Some rays, and what rendering them should give."""

    rays: Rays
    target: Float32[Tensor, "r 3"]
    background: Float32[Tensor, "r 3"]
    measured_depth: Float32[Tensor, "r"] | None  # along the ray; 0: not measured


class RaySampler:
    """The images of a scene at one resolution, and those of their pixels that can see points.

    A pixel outside the `footprint` of the cloud points sees background whatever they hold, so
    there is nothing to learn from it.
    """

    def __init__(self, scene: NerfScene, mask: Bool[Tensor, "n h w"]) -> None:
        self._cameras, self._background = scene.cameras, scene.background
        self.height, self.width = mask.shape[1:]
        self.colors = downsample_images(scene, self.height, self.width)
        self._depth_maps = (
            None if scene.depth is None else downsample_depth(scene.depth, self.height, self.width)
        )
        self.visible_pixels = mask.nonzero()  # view, row, column
        self._scale = torch.tensor(
            [scene.cameras.width / self.width, scene.cameras.height / self.height],
            device=self.colors.device,
        )

    def with_mask(self, mask: Bool[Tensor, "n h w"]) -> "RaySampler":
        """A sampler of the same images and of other pixels."""
        sampler = copy(self)
        sampler.visible_pixels = mask.nonzero()
        return sampler

    def sample(self, count: int, noise: float, generator: torch.Generator) -> RayBatch:
        """The rays of random pixels; `noise` is the standard deviation of that of their colors."""
        pixels, offsets = self.sample_pixels(count, generator)
        rays, colors, background = self.rays(pixels, offsets)
        target = add_noise(colors, noise, generator)
        return RayBatch(rays, target, background, self.ray_depths(pixels, rays))

    def sample_pixels(
        self, count: int, generator: torch.Generator
    ) -> tuple[Int64[Tensor, "r 3"], Float32[Tensor, "r"]]:
        """Random pixels (view, row, column), and the offset in [0, 1) of each ray's samples."""
        indices = torch.randint(len(self.visible_pixels), (count,), generator=generator)
        offsets = torch.rand(count, generator=generator)
        indices, offsets = (
            x.to(self.visible_pixels.device, non_blocking=True) for x in (indices, offsets)
        )
        return self.visible_pixels[indices], offsets

    def rays(
        self, pixels: Int64[Tensor, "r 3"], offsets: Float32[Tensor, "r"]
    ) -> tuple[Rays, Float32[Tensor, "r 3"], Float32[Tensor, "r 3"]]:
        """The rays through the centers of these pixels, their colors, and the background."""
        view, row, column = pixels.unbind(1)
        uv = (torch.stack([column, row], dim=1) + 0.5) * self._scale
        rays = self._cameras.rays(view, uv, offsets)
        return rays, self.colors[view, row, column], self._background[view]

    def ray_depths(self, pixels: Int64[Tensor, "r 3"], rays: Rays) -> Float32[Tensor, "r"] | None:
        """Measured depth of each pixel as distance along its ray; 0 or None: not measured."""
        if self._depth_maps is None:
            return None
        view, row, column = pixels.unbind(1)
        axis = self._cameras.c2w[view, :3, 2]
        return self._depth_maps[view, row, column] / (rays.directions * axis).sum(dim=1)


def add_noise(
    colors: Float32[Tensor, "*any"], std: float, generator: torch.Generator
) -> Float32[Tensor, "*any"]:
    """`colors` plus Gaussian noise of this standard deviation; 0 draws no random number."""
    if not std:
        return colors
    return colors + std * torch.randn(colors.shape, generator=generator).to(colors)


def downsample_images(scene: NerfScene, height: int, width: int) -> Float32[Tensor, "n h w 3"]:
    """The images in [0, 1], scaled down by averaging."""
    resized = [
        adaptive_avg_pool2d(image.permute(2, 0, 1).float() / 255, (height, width)).permute(1, 2, 0)
        for image in scene.images
    ]
    return torch.stack(resized)


def downsample_depth(
    depth: Float32[Tensor, "n h w"], height: int, width: int
) -> Float32[Tensor, "n sh sw"]:
    """Depth maps, scaled down by averaging; 0 unless all pixels averaged are of one surface."""
    size = (height, width)
    farthest, nearest = adaptive_max_pool2d(depth, size), -adaptive_max_pool2d(-depth, size)
    is_one_surface = (nearest > 0) & (farthest - nearest < DEPTH_EDGE)
    return torch.where(is_one_surface, adaptive_avg_pool2d(depth, size), 0.0)


def footprint(
    points: Float32[Tensor, "m 3"], spacing: float, cameras: TorchCameras, image_px: int
) -> Bool[Tensor, "n h w"]:
    """Pixels whose rays may pass within `spacing` of a point, for every camera.

    Points behind the camera or within `spacing` of it are left out.
    """
    width, height = reduced_size(cameras.width, cameras.height, image_px)
    masks = torch.zeros(len(cameras), height, width, dtype=torch.bool, device=points.device)
    scale = points.new_tensor([width / cameras.width, height / cameras.height])
    for mask, K, c2w in zip(masks, cameras.K, cameras.c2w, strict=True):
        uv, depth = project(points, K, c2w)
        in_front = depth > spacing
        if in_front.any():
            uv, depth = uv[in_front] * scale, depth[in_front]
            focal, center = K.diagonal()[:2] * scale, K[:2, 2] * scale
            radius_px = projected_radius(uv - center, depth, focal, spacing, max(height, width))
            mask |= dilate(uv, height, width, radius_px)
    return masks


def target_footprint(
    points: Float32[Tensor, "m 3"],
    spacing: float,
    cameras: TorchCameras,
    image_px: int,
    reading: TargetViewsReading,
) -> Bool[Tensor, "n h w"]:
    """`footprint` in the target views of R10; empty in the others."""
    visible = footprint(points, spacing, cameras, image_px)
    target_pixels, target_views = torch.zeros_like(visible), source_target_split(reading).target
    target_pixels[target_views] = visible[target_views]
    return target_pixels


def projected_radius(
    offsets: Float32[Tensor, "m 2"],
    depth: Float32[Tensor, "m"],
    focal: Float32[Tensor, "2"],
    radius: float,
    max_px: int,
) -> int:
    """Largest extent (px, along either axis) of the images of balls of `radius` from their centers.

    `offsets` are the centers' pixels from the principal point.  A point moved by (dx, dz) moves by
    f (z dx - x dz) / (z (z + dz)): with radius r, by f r sqrt(1 + (x/z)^2) / (z - r) at most.
    """
    slant = (1 + (offsets / focal) ** 2).sqrt()
    radius_px = (focal * slant * radius / (depth - radius)[:, None]).max()
    return int(radius_px.clamp(max=max_px).ceil())


def dilate(uv: Float32[Tensor, "m 2"], height: int, width: int, radius: int) -> Bool[Tensor, "h w"]:
    """Pixels at most `radius` rows and columns from one of the points `uv`, px."""
    column, row = (uv.floor() + radius).unbind(1)
    # points beside the image reach into it
    padded_height, padded_width = height + 2 * radius, width + 2 * radius
    inside = (column >= 0) & (column < padded_width) & (row >= 0) & (row < padded_height)
    mask = torch.zeros(1, padded_height, padded_width, device=uv.device)
    mask[0, row[inside].long(), column[inside].long()] = 1
    dilated_rows = max_pool2d(mask, (1, 2 * radius + 1), stride=1)
    return max_pool2d(dilated_rows, (2 * radius + 1, 1), stride=1)[0] > 0
