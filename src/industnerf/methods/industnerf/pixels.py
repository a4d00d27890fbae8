"""Which pixels are looked at, and at what resolution: the training signal, R10."""

from copy import copy

import torch
from jaxtyping import Bool, Float32, Int64
from torch import Tensor
from torch.nn.functional import adaptive_avg_pool2d, adaptive_max_pool2d, max_pool2d

from industnerf.geometry.cameras import reduced_size
from industnerf.methods.industnerf.projection import project
from industnerf.methods.industnerf.scene import Eyes, Scene
from industnerf.rendering.render import Rays

STEEP = 0.02  # of the unit ball: readings of one pixel that differ more are of an edge


class Pixels:
    """The images of a scene at one resolution, and those of their pixels that can show points.

    A pixel beside the `footprint` of all cloud points sees nothing but background, whatever
    their densities and colours: there is nothing to learn from it.
    """

    def __init__(self, scene: Scene, footprint: Bool[Tensor, "n h w"]) -> None:
        self._eyes, self._background = scene.eyes, scene.background
        self.height, self.width = footprint.shape[1:]
        self.colours = averaged(scene, self.height, self.width)
        self._depths = None if scene.depth is None else read(scene.depth, self.height, self.width)
        self.shown = footprint.nonzero()  # view, row, column
        self._scale = torch.tensor(
            [scene.eyes.width / self.width, scene.eyes.height / self.height],
            device=self.colours.device,
        )

    def showing(self, footprint: Bool[Tensor, "n h w"]) -> "Pixels":
        """The same images, of which the pixels of another footprint are looked at."""
        others = copy(self)
        others.shown = footprint.nonzero()
        return others

    def draw(
        self, count: int, generator: torch.Generator
    ) -> tuple[Int64[Tensor, "r 3"], Float32[Tensor, "r"]]:
        """Random pixels (view, row, column), and how far each one's samples are shifted."""
        which = torch.randint(len(self.shown), (count,), generator=generator)
        offsets = torch.rand(count, generator=generator)
        which, offsets = (x.to(self.shown.device, non_blocking=True) for x in (which, offsets))
        return self.shown[which], offsets

    def rays(
        self, pixels: Int64[Tensor, "r 3"], offsets: Float32[Tensor, "r"]
    ) -> tuple[Rays, Float32[Tensor, "r 3"], Float32[Tensor, "r 3"]]:
        """The rays through these pixels, their colours, and the background behind them."""
        view, row, column = pixels.unbind(1)
        uv = (torch.stack([column, row], dim=1) + 0.5) * self._scale
        rays = self._eyes.rays(view, uv, offsets)
        return rays, self.colours[view, row, column], self._background[view]

    def distances(self, pixels: Int64[Tensor, "r 3"], rays: Rays) -> Float32[Tensor, "r"] | None:
        """How far along its ray each pixel's reading of depth is; 0 or None: there is none."""
        if self._depths is None:
            return None
        view, row, column = pixels.unbind(1)
        axis = self._eyes.c2w[view, :3, 2]
        return self._depths[view, row, column] / (rays.directions * axis).sum(dim=1)


def noisier(
    colours: Float32[Tensor, "*any"], deviation: float, generator: torch.Generator
) -> Float32[Tensor, "*any"]:
    """`colours` with fresh noise of this standard deviation; 0 draws nothing."""
    if not deviation:
        return colours
    return colours + deviation * torch.randn(colours.shape, generator=generator).to(colours)


def averaged(scene: Scene, height: int, width: int) -> Float32[Tensor, "n h w 3"]:
    """The images in [0, 1], each pixel the mean of those that it stands for."""
    small = [
        adaptive_avg_pool2d(image.permute(2, 0, 1).float() / 255, (height, width)).permute(1, 2, 0)
        for image in scene.images
    ]
    return torch.stack(small)


def read(depth: Float32[Tensor, "n h w"], height: int, width: int) -> Float32[Tensor, "n sh sw"]:
    """Mean depth of the pixels that each one stands for; 0 unless all are of one surface."""
    size = (height, width)
    farthest, nearest = adaptive_max_pool2d(depth, size), -adaptive_max_pool2d(-depth, size)
    whole = (nearest > 0) & (farthest - nearest < STEEP)
    return torch.where(whole, adaptive_avg_pool2d(depth, size), 0.0)


def footprint(
    points: Float32[Tensor, "m 3"], spacing: float, eyes: Eyes, longest: int
) -> Bool[Tensor, "n h w"]:
    """Pixels whose rays may pass a point nearer than `spacing`, from every camera.

    Points up to `spacing` in front of the camera, and those behind it, are not looked for.
    """
    width, height = reduced_size(eyes.width, eyes.height, longest)
    masks = torch.zeros(len(eyes), height, width, dtype=torch.bool, device=points.device)
    scale = points.new_tensor([width / eyes.width, height / eyes.height])
    for mask, K, c2w in zip(masks, eyes.K, eyes.c2w, strict=True):
        uv, depth = project(points, K, c2w)
        front = depth > spacing
        if front.any():
            uv, depth = uv[front] * scale, depth[front]
            focal, centre = K.diagonal()[:2] * scale, K[:2, 2] * scale
            reach = reach_px(uv - centre, depth, focal, spacing, max(height, width))
            mask |= grown(uv, height, width, reach)
    return masks


def reach_px(
    off: Float32[Tensor, "m 2"],
    depth: Float32[Tensor, "m"],
    focal: Float32[Tensor, "2"],
    radius: float,
    most: int,
) -> int:
    """How far from their centres, along either axis, the images of balls of `radius` end, px.

    `off` is where the centres are, from the principal point.  A point moved by (dx, dz) moves by
    f (z dx - x dz) / (z (z + dz)): with radius r, by f r sqrt(1 + (x/z)^2) / (z - r) at most.
    """
    slant = (1 + (off / focal) ** 2).sqrt()
    reach = (focal * slant * radius / (depth - radius)[:, None]).max()
    return int(reach.clamp(max=most).ceil())


def grown(uv: Float32[Tensor, "m 2"], height: int, width: int, reach: int) -> Bool[Tensor, "h w"]:
    """Pixels that are at most `reach` rows and columns from one of the points `uv`, px."""
    column, row = (uv.floor() + reach).unbind(1)
    tall, wide = height + 2 * reach, width + 2 * reach  # points beside the image reach into it
    inside = (column >= 0) & (column < wide) & (row >= 0) & (row < tall)
    mask = torch.zeros(1, tall, wide, device=uv.device)
    mask[0, row[inside].long(), column[inside].long()] = 1
    along = max_pool2d(mask, (1, 2 * reach + 1), stride=1)
    return max_pool2d(along, (2 * reach + 1, 1), stride=1)[0] > 0
