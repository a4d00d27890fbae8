"""PosE, eqs. (1)-(3): what the network is told of where a point is.  Readings R1 and R2.

The printed form sin(a x + b 6j/C) has one frequency only: all of an axis's channels lie in the
span of sin(a x) and cos(a x), so the encoding has rank 6 whatever C is.  Meant is the encoding
of Point-NN, sin(a x / b^(6j/C)), with `magnitude` a and `base` b.

Its shortest wave is 2 pi / a long.  On a grid, spacings of more than pi / a alias: the first
channels then look like slow waves that are not there.  So a <= pi / spacing, which for r points
on each side of [-1, 1] is about 1.5 r.
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
    """The coordinates that are encoded, one row a point.

    camera: the points in the camera's frame, as 3.1 says in words.  world: the points as they
    are.  pose: eq. (4) to the letter, PosE(P) of the camera's center, alike for all points.
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
    """How many columns `encode` returns.  BadParams unless the paper's C is a multiple of 6."""
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

    The phases of x, with j = 0 .. C/6 - 1:  intended  magnitude x / base^(6j/C);
    printed  magnitude x + base 6j/C;  nerf  2^j pi x, without magnitude and base.
    identity: no encoding, the coordinates themselves.  Axes follow one another: x, y, z.
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
