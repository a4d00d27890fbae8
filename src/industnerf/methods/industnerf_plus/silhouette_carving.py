"""Silhouettes of the part in all views, and the visual hull that they bound."""

import numpy as np
import torch
from jaxtyping import Bool, Float32
from torch import Tensor

from industnerf.geometry.silhouettes import foreground_mask
from industnerf.methods.industnerf.projection import is_in_view, project, sample_features
from industnerf.methods.industnerf.scene import NerfScene
from industnerf.methods.industnerf_plus.distance_transform import distance_transform

MAX_DISTANCE = 2.0  # beyond the region of interest, and of any view


class Silhouettes:
    """The foreground of each view, and the distance (px) of each pixel from its outline."""

    def __init__(self, scene: NerfScene, tolerance: float) -> None:
        self._cameras, self._focal = scene.cameras, scene.cameras.K[:, [0, 1], [0, 1]].amax(dim=1)
        images, background = scene.images.cpu().numpy(), scene.background.cpu().numpy()
        is_part = torch.from_numpy(foreground_mask(images, background, tolerance)).to(
            scene.images.device
        )
        self._distance_outside, inside = map(distance_transform, (is_part, ~is_part))
        self._signed_distance = torch.where(
            self._distance_outside > 0, self._distance_outside - 0.5, 0.5 - inside
        )

    @property
    def device(self) -> torch.device:
        """The device of the points."""
        return self._distance_outside.device

    def outlines(self) -> Float32[np.ndarray, "n h w"]:
        """Signed distance (px) of each pixel from the outline, positive inside."""
        return (-self._signed_distance).cpu().numpy()

    def distance(self, points: Float32[Tensor, "m 3"]) -> Float32[Tensor, "m"]:
        """Signed distance of each point from the visual hull, in the unit frame; < 0 inside.

        A lower bound: the maximum over the views of the distance of the point's pixel from the
        outline, at the point's depth and the longer focal length.  Views that do not have the
        point in frame are left out.
        """
        hull_distance = torch.full_like(points[:, 0], -torch.inf)
        height, width = self._distance_outside.shape[1:]
        for K, c2w, focal, view_signed_distance in zip(
            self._cameras.K, self._cameras.c2w, self._focal, self._signed_distance, strict=True
        ):
            uv, depth = project(points, K, c2w)
            in_frame = is_in_view(uv, depth, width, height)
            distance_px = sample_features(
                view_signed_distance[None], uv.masked_fill(~in_frame[:, None], 0.0), width, height
            )
            view_distance = distance_px[:, 0] * depth / focal
            hull_distance = torch.maximum(
                hull_distance, torch.where(in_frame, view_distance, -torch.inf)
            )
        return hull_distance.clamp(-MAX_DISTANCE, MAX_DISTANCE)

    def inside_hull(self, points: Float32[Tensor, "m 3"], margin: float) -> Bool[Tensor, "m"]:
        """False for points that some view sees more than `margin` outside its silhouette.

        `margin` is a length in the unit frame.  One pixel more is allowed, because an outline may
        cover a pixel and not its center.
        """
        kept = torch.arange(len(points), device=points.device)
        for K, c2w, focal, view_distance_outside in zip(
            self._cameras.K, self._cameras.c2w, self._focal, self._distance_outside, strict=True
        ):
            uv, depth = project(points[kept], K, c2w)
            in_frame = is_in_view(uv, depth, self._cameras.width, self._cameras.height)
            column, row = uv.masked_fill(~in_frame[:, None], 0.0).long().unbind(1)
            is_inside = view_distance_outside[row, column] <= margin * focal / depth + 1
            kept = kept[is_inside | ~in_frame]
        mask = torch.zeros(len(points), dtype=torch.bool, device=points.device)
        mask[kept] = True
        return mask
