"""Random augmentation of images: roll, zoom, color, noise.

No mirror images, which the published networks learned from: a mirrored screw is another screw.
"""

import numpy as np
import torch
from jaxtyping import Float, UInt8
from torch import Tensor
from torch.nn import functional as F

from industnerf.schema import AugmentSettings


def images_to_tensor(
    images: UInt8[np.ndarray, "n h w 3"], device: torch.device
) -> Float[Tensor, "n 3 h w"]:
    """Values in [0, 1]; the array, in C order, goes to `device` as bytes."""
    return torch.from_numpy(images).to(device).permute(0, 3, 1, 2).contiguous().float() / 255


def augment(
    images: Float[Tensor, "n 3 h w"], settings: AugmentSettings, rng: np.random.Generator
) -> tuple[Float[Tensor, "n 3 h w"], Float[np.ndarray, "n 3 3"]]:
    """Every image rolled, zoomed and shifted in brightness and contrast, each as drawn for it.

    And the rotation R of the camera's axes with it: a point p in its frame is seen at p @ R.

    A roll of the camera about its axis by up to `roll_deg`, a zoom by a factor of up to
    1 +- `zoom`, and colors c -> a c + b with a in 1 +- `color_jitter` and b in
    +- `color_jitter` / 2; then noise of the standard deviation `noise`, if any.
    """
    n = len(images)
    angle = np.deg2rad(rng.uniform(-settings.roll_deg, settings.roll_deg, n))
    zoom = rng.uniform(1 - settings.zoom, 1 + settings.zoom, n)
    matrices = np.zeros((n, 2, 3))
    matrices[:, 0, 0] = matrices[:, 1, 1] = np.cos(angle) / zoom
    matrices[:, 0, 1], matrices[:, 1, 0] = -np.sin(angle) / zoom, np.sin(angle) / zoom
    grid = F.affine_grid(
        torch.from_numpy(matrices).to(images), list(images.shape), align_corners=False
    )
    # beyond the border the image continues as it is there: background
    warped = F.grid_sample(images, grid, padding_mode="border", align_corners=False)
    gain = rng.uniform(1 - settings.color_jitter, 1 + settings.color_jitter, n)
    shift = rng.uniform(-settings.color_jitter / 2, settings.color_jitter / 2, n)
    factors = [torch.from_numpy(x).to(images).view(n, 1, 1, 1) for x in (gain, shift)]
    adjusted = warped * factors[0] + factors[1]
    if settings.noise:
        noise = rng.normal(0.0, settings.noise, tuple(images.shape))
        adjusted = adjusted + torch.from_numpy(noise).to(images)
    return adjusted.clamp(0, 1), _roll_matrices(angle)


def _roll_matrices(angle: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n 3 3"]:
    """About the optical axis, so that what is to the right goes up."""
    rotations = np.tile(np.eye(3), (len(angle), 1, 1))
    rotations[:, 0, 0] = rotations[:, 1, 1] = np.cos(angle)
    rotations[:, 1, 0], rotations[:, 0, 1] = np.sin(angle), -np.sin(angle)
    return rotations
