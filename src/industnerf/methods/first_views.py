"""The views that a network predicts from: the first in nested order, as it was trained."""

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from industnerf.geometry.cameras import nested_view_order
from industnerf.learning.augment import contrast_to_background
from industnerf.learning.views import picture_frames, resize_images
from industnerf.methods.base import MethodInputs


def first_views(
    inputs: MethodInputs, count: int, px: int, device: torch.device
) -> tuple[Float[Tensor, "n 3 {px} {px}"], Float[np.ndarray, "n 3 3"]]:
    """At most `count` views that look from farthest apart, `px` a side, and their picture frames.

    The views are given as contrasts to the background.
    """
    indices = nested_view_order(inputs.cameras.centers, min(count, len(inputs.rgb)))
    images = resize_images(inputs.rgb[indices], px)
    contrasts = contrast_to_background(images, inputs.background[indices], device)
    return contrasts, picture_frames(inputs.cameras[indices], inputs.part_frame)
