"""Free space from background pixels: an addition to the paper, for `industnerf_plus`."""

import numpy as np
import torch
from jaxtyping import Bool, Float32
from torch import Tensor

from industnerf.geometry.silhouettes import NEAR, part_in
from industnerf.methods.industnerf.distances import distance_transform
from industnerf.methods.industnerf.projection import in_view, project, sample_features
from industnerf.methods.industnerf.scene import Scene

FAR = 2.0  # beyond the region of interest, and of any view


class Silhouettes:
    """Where each view shows the part (`part_in`), and how far off its outline each pixel is, px."""

    def __init__(self, scene: Scene, tolerance: float) -> None:
        self._eyes, self._focal = scene.eyes, scene.eyes.K[:, [0, 1], [0, 1]].amax(dim=1)
        images, background = scene.images.cpu().numpy(), scene.background.cpu().numpy()
        part = torch.from_numpy(part_in(images, background, tolerance)).to(scene.images.device)
        self._outside, inside = map(distance_transform, (part, ~part))
        self._signed = torch.where(self._outside > 0, self._outside - 0.5, 0.5 - inside)

    @property
    def device(self) -> torch.device:
        """Where points must be."""
        return self._outside.device

    def outlines(self) -> Float32[np.ndarray, "n h w"]:
        """As `geometry.silhouettes.outlines` of the part, of what is known already."""
        return (-self._signed).clamp(0.5 - NEAR, NEAR - 0.5).cpu().numpy()

    def distance(self, points: Float32[Tensor, "m 3"]) -> Float32[Tensor, "m"]:
        """How far each point is outside the visual hull, in the scene's unit; < 0 inside.

        The most that any view says: how far the silhouette's outline is from the point's pixel,
        at the point's depth and at the longer of two focal lengths, so at least that far.  Views
        that do not have the point in frame say nothing.
        """
        most = torch.full_like(points[:, 0], -torch.inf)
        height, width = self._outside.shape[1:]
        for K, c2w, focal, signed in zip(
            self._eyes.K, self._eyes.c2w, self._focal, self._signed, strict=True
        ):
            uv, depth = project(points, K, c2w)
            seen = in_view(uv, depth, width, height)
            px = sample_features(signed[None], uv.masked_fill(~seen[:, None], 0.0), width, height)
            away = px[:, 0] * depth / focal
            most = torch.maximum(most, torch.where(seen, away, -torch.inf))
        return most.clamp(-FAR, FAR)

    def may_hold(self, points: Float32[Tensor, "m 3"], slack: float) -> Bool[Tensor, "m"]:
        """False for points that some view sees before background, farther than `slack` from it.

        `slack` is a length in the scene's unit: cells that reach into the silhouette stay.  So
        does what is within a pixel of it: an outline may cover a pixel, and not its centre.
        """
        kept = torch.arange(len(points), device=points.device)
        for K, c2w, focal, outside in zip(
            self._eyes.K, self._eyes.c2w, self._focal, self._outside, strict=True
        ):
            uv, depth = project(points[kept], K, c2w)
            seen = in_view(uv, depth, self._eyes.width, self._eyes.height)
            column, row = uv.masked_fill(~seen[:, None], 0.0).long().unbind(1)
            inside = outside[row, column] <= slack * focal / depth + 1
            kept = kept[inside | ~seen]
        mask = torch.zeros(len(points), dtype=torch.bool, device=points.device)
        mask[kept] = True
        return mask
