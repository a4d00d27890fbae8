"""From confidence to the final cloud: reading R11."""

from typing import assert_never

import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.methods.industnerf.witnesses import Surface, Testimony, thinned
from industnerf.schema.readings import CloudReading


def final_cloud(
    points: Float32[Tensor, "m 3"],
    rgb: Float32[Tensor, "m 3"],
    told: Testimony,
    least: float,
    spacing: float,
    reading: CloudReading,
) -> Surface:
    """The points that are kept, their colours, confidences and the views that are surest.

    confident: the cloud points of confidence (13) of at least `least`.
    surface: where pixels see the surface, if sure by `least`, one point a cell of side `spacing`.
    """
    match reading:
        case "confident":
            sure = told.confidence >= max(least, torch.finfo(torch.float32).tiny)
            return Surface(points[sure], rgb[sure], told.confidence[sure], told.view[sure])
        case "surface":
            sure = told.surface.confidence >= least
            return thinned(Surface(*(x[sure] for x in vars(told.surface).values())), spacing)
        case _:
            assert_never(reading)
