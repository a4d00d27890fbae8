"""Section 3.1, PosE, eqs. (1)-(3): positional encoding of the points.  Readings R1 and R2.

The printed form sin(alpha x + beta 6j/C) has one frequency: all channels of an axis lie in the
span of sin(alpha x) and cos(alpha x), so the encoding has rank 6 whatever C is.  Meant is the
encoding of Point-NN, sin(alpha x / beta^(6j/C)).

Its shortest wavelength is 2 pi / alpha.  On a grid, spacings above pi / alpha alias.  So alpha is
at most pi / spacing, which for r points on each side of [-1, 1] is about 1.5 r.
"""

import math
from typing import assert_never

import torch
from jaxtyping import Float
from torch import Tensor

from industnerf.errors import BadParams
from industnerf.methods.industnerf.projection import world_to_camera
from industnerf.schema.readings import EncodingFrameReading, PositionEncodingReading


def encoding_coordinates(
    points: Float[Tensor, "n 3"], c2w: Float[Tensor, "4 4"], reading: EncodingFrameReading
) -> Float[Tensor, "n 3"]:
    """The coordinates to encode, a row a point.  Reading R2.

    camera: the points in the camera's frame, as the text of 3.1 has it.  world: the points.
    camera_center: eq. (4) to the letter, PosE(P) of the camera's center, equal for all points.
    """
    match reading:
        case "camera":
            return world_to_camera(points, c2w)
        case "world":
            return points
        case "camera_center":
            return c2w[:3, 3].expand(len(points), 3)
        case _:
            assert_never(reading)


def encoding_channels(channels: int, reading: PositionEncodingReading) -> int:
    """Columns of `encode_positions`.  Raises BadParams unless C is a multiple of 6."""
    if reading == "identity":
        return 3
    if channels < 6 or channels % 6:
        raise BadParams(
            f"PosE of {channels} channels: C must be a positive multiple of 6, a sine and a "
            "cosine for each of three axes"
        )
    return channels


def encode_positions(
    points: Float[Tensor, "n 3"],
    channels: int,
    alpha: float,
    beta: float,
    reading: PositionEncodingReading,
) -> Float[Tensor, "n c"]:
    """Eqs. (1)-(3): channels [2j] and [2j + 1] of an axis are sine and cosine of one phase.

    Reading R1, the phases of x with j = 0 .. C/6 - 1:  intended: alpha x / beta^(6j/C);
    printed: alpha x + beta 6j/C;  nerf: 2^j pi x;  identity: the coordinates, not encoded.
    The columns are those of x, then y, then z.
    """
    out_channels = encoding_channels(channels, reading)
    if reading == "identity":
        return points
    x = points[:, :, None]
    j = torch.arange(out_channels // 6, dtype=points.dtype, device=points.device)
    match reading:
        case "intended":
            phase = alpha * x / beta ** (6 * j / channels)
        case "printed":
            phase = alpha * x + beta * 6 * j / channels
        case "nerf":
            phase = math.pi * x * 2**j
        case _:
            assert_never(reading)
    return torch.stack([phase.sin(), phase.cos()], dim=-1).reshape(len(points), out_channels)
