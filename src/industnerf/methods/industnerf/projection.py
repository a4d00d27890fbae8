"""Section 3.1, points in a camera's frame and in its image, and pi(F, P, X) of eq. (4).

Conventions of `geometry.cameras`, in torch: OpenCV axes, pixel (0, 0) is the top-left corner,
the first center is (0.5, 0.5).  Lengths are in any one unit.
"""

import torch
from jaxtyping import Bool, Float
from torch import Tensor
from torch.nn.functional import grid_sample


def world_to_camera(
    points: Float[Tensor, "n 3"], c2w: Float[Tensor, "4 4"]
) -> Float[Tensor, "n 3"]:
    """World points in the frame of the camera."""
    return (points - c2w[:3, 3]) @ c2w[:3, :3]


def project(
    points: Float[Tensor, "n 3"], K: Float[Tensor, "3 3"], c2w: Float[Tensor, "4 4"]
) -> tuple[Float[Tensor, "n 2"], Float[Tensor, "n"]]:
    """Pixel coordinates (px) and depth (z in the camera frame) of world points.

    A point of depth 0 has no pixel: its coordinates are not finite, and `is_in_view` is false.
    """
    camera = world_to_camera(points, c2w)
    homogeneous = camera @ K.T
    return homogeneous[:, :2] / homogeneous[:, 2:], camera[:, 2]


def is_in_view(
    uv: Float[Tensor, "n 2"], depth: Float[Tensor, "n"], width: int, height: int
) -> Bool[Tensor, "n"]:
    """Whether a point is in front of the camera and projects into the image."""
    u, v = uv.unbind(-1)
    return (depth > 0) & (u >= 0) & (u < width) & (v >= 0) & (v < height)


def sample_features(
    features: Float[Tensor, "c h w"], uv: Float[Tensor, "n 2"], width: int, height: int
) -> Float[Tensor, "n c"]:
    """pi(F, P, X) of eq. (4): features at `uv`, bilinear between the texels' centers.

    `uv` are px of the image, `width` x `height` its size.  The feature map covers the whole image
    at any resolution.  Outside the outermost centers the border is repeated, so every value is
    finite.
    """
    size = torch.tensor([width, height], dtype=uv.dtype, device=uv.device)
    # grid_sample counts the image from -1 to 1, from edge to edge if corners are not aligned
    grid = (2 * uv / size - 1)[None, None]
    sampled = grid_sample(features[None], grid, padding_mode="border", align_corners=False)
    return sampled[0, :, 0].T
