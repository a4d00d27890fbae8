"""Free space from background pixels: an addition to the paper, for `industnerf_plus`."""

import torch
from jaxtyping import Bool, Float32
from scipy.ndimage import distance_transform_edt
from torch import Tensor

from industnerf.methods.industnerf.projection import in_view, project
from industnerf.methods.industnerf.scene import Scene

TOLERANCE = 0.02  # a channel this far from the background's is not background


class Silhouettes:
    """How far outside the part's silhouette each pixel of each view is."""

    def __init__(self, scene: Scene) -> None:
        self._eyes = scene.eyes
        colours = scene.images.float() / 255
        part = ((colours - scene.background[:, None, None]).abs() > TOLERANCE).any(dim=-1)
        outside = [
            torch.from_numpy(distance_transform_edt(~mask.cpu().numpy())).float() for mask in part
        ]
        self._outside = torch.stack(outside).to(scene.images.device)

    def may_hold(self, points: Float32[Tensor, "m 3"], slack: float) -> Bool[Tensor, "m"]:
        """False for points that some view sees before background, farther than `slack` from it.

        `slack` is a length in the scene's unit: cells that reach into the silhouette stay.  So
        does what is within a pixel of it: an outline may cover a pixel, and not its centre.
        """
        kept = torch.arange(len(points), device=points.device)
        for K, c2w, outside in zip(self._eyes.K, self._eyes.c2w, self._outside, strict=True):
            uv, depth = project(points[kept], K, c2w)
            seen = in_view(uv, depth, self._eyes.width, self._eyes.height)
            column, row = uv.nan_to_num(0).clamp(min=0).long().unbind(1)
            column = column.clamp(max=self._eyes.width - 1)
            row = row.clamp(max=self._eyes.height - 1)
            inside = outside[row, column] <= slack * K[0, 0] / depth + 1
            kept = kept[inside | ~seen]
        mask = torch.zeros(len(points), dtype=torch.bool, device=points.device)
        mask[kept] = True
        return mask
