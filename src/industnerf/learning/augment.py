"""Random augmentation of images: roll, zoom, color, noise.

No mirror images, which the published networks learned from: a mirrored screw is another screw.
"""

import numpy as np
import torch
from jaxtyping import Float, UInt8
from torch import Tensor
from torch.nn import functional as F

from industnerf.schema import AugmentSettings

# by which networks multiply contrasts: a gray part before white is then about 1
INPUT_GAIN = 2.0


def contrast_to_background(
    images: UInt8[np.ndarray, "n h w 3"],
    background: Float[np.ndarray, "n 3"],
    device: torch.device,
) -> Float[Tensor, "n 3 h w"]:
    """Background less image, in [-1, 1]: 0 wherever the part is not, on whatever background.

    Networks that are shown white as 1 can end blind to their images: all of them are mostly
    background, whose large constant hides what differs.
    """
    pixels = torch.from_numpy(images).to(device).permute(0, 3, 1, 2).contiguous().float()
    return torch.from_numpy(background).to(pixels)[..., None, None] - pixels / 255


def augment(
    contrasts: Float[Tensor, "n 3 h w"], settings: AugmentSettings, rng: np.random.Generator
) -> tuple[Float[Tensor, "n 3 h w"], Float[np.ndarray, "n 3 3"]]:
    """Every one rolled, zoomed and with each color scaled, each as drawn for it.

    And the matrix A of the picture's axes with it: a point p in its frame is seen at p @ A.

    A roll of the camera about its axis by up to `roll_deg`, a zoom by a factor of up to
    1 +- `zoom`, and each color times a factor of up to 1 +- `color_jitter`; then noise of the
    standard deviation `noise`, if any.  The background stays 0.
    """
    n = len(contrasts)
    angle = np.deg2rad(rng.uniform(-settings.roll_deg, settings.roll_deg, n))
    zoom = rng.uniform(1 - settings.zoom, 1 + settings.zoom, n)
    if settings.roll_deg or settings.zoom:
        contrasts = _warped(contrasts, angle, zoom)
    gain = rng.uniform(1 - settings.color_jitter, 1 + settings.color_jitter, (n, 3, 1, 1))
    adjusted = contrasts * torch.from_numpy(gain).to(contrasts)
    if settings.noise:
        noise = rng.normal(0.0, settings.noise, tuple(contrasts.shape))
        adjusted = adjusted + torch.from_numpy(noise).to(contrasts)
    return adjusted.clamp(-1, 1), zoom[:, None, None] * _roll_matrices(angle)


def _warped(
    contrasts: Float[Tensor, "n 3 h w"], angle: Float[np.ndarray, "n"], zoom: Float[np.ndarray, "n"]
) -> Float[Tensor, "n 3 h w"]:
    matrices = np.zeros((len(angle), 2, 3))
    matrices[:, 0, 0] = matrices[:, 1, 1] = np.cos(angle) / zoom
    matrices[:, 0, 1], matrices[:, 1, 0] = -np.sin(angle) / zoom, np.sin(angle) / zoom
    grid = F.affine_grid(
        torch.from_numpy(matrices).to(contrasts), list(contrasts.shape), align_corners=False
    )
    # beyond the border the image continues as it is there: background
    return F.grid_sample(contrasts, grid, padding_mode="border", align_corners=False)


def _roll_matrices(angle: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n 3 3"]:
    """About the optical axis, so that what is to the right goes up."""
    rotations = np.tile(np.eye(3), (len(angle), 1, 1))
    rotations[:, 0, 0] = rotations[:, 1, 1] = np.cos(angle)
    rotations[:, 1, 0], rotations[:, 0, 1] = np.sin(angle), -np.sin(angle)
    return rotations
