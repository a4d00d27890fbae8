"""From confidence to the final cloud: reading R11."""

from typing import assert_never

import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.methods.industnerf.fused import fused
from industnerf.methods.industnerf.scene import Posed
from industnerf.methods.industnerf.witnesses import Surface, Testimony, thinned
from industnerf.schema import IndustnerfSettings
from industnerf.schema.readings import CloudReading


def final_cloud(
    points: Float32[Tensor, "m 3"],
    rgb: Float32[Tensor, "m 3"],
    told: Testimony,
    posed: Posed,
    ways: IndustnerfSettings,
    reading: CloudReading,
    seed: int,
) -> Surface:
    """The points of the cloud, their colours, confidences and the views that are surest.

    confident: the cloud points whose confidence (13) is at least `least_confidence`.
    surface: where pixels see the surface, if they are as sure, one point a cell of side `spacing`.
    fused: on the surface on which the views agree, drawn by `seed` (`fused.fused`).
    """
    least = ways.least_confidence
    match reading:
        case "confident":
            sure = told.confidence >= max(least, torch.finfo(torch.float32).tiny)
            return Surface(points[sure], rgb[sure], told.confidence[sure], told.view[sure])
        case "surface":
            return thinned(told.surface.only(told.surface.confidence >= least), ways.spacing)
        case "fused":
            return fused(told.surface, posed, ways, seed)
        case _:
            assert_never(reading)
