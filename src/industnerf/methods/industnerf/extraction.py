"""From confidence to the final cloud: reading R11."""

from typing import assert_never

import torch
from jaxtyping import Float32
from torch import Tensor

from industnerf.methods.industnerf.scene import PosedImages
from industnerf.methods.industnerf.tsdf_fusion import fuse_surface
from industnerf.methods.industnerf.view_confidence import (
    ObservedSurface,
    ViewConfidence,
    voxel_downsample,
)
from industnerf.schema import IndustnerfSettings
from industnerf.schema.readings import ExtractionReading


def extract_point_cloud(
    points: Float32[Tensor, "m 3"],
    rgb: Float32[Tensor, "m 3"],
    view_confidence: ViewConfidence,
    posed: PosedImages,
    settings: IndustnerfSettings,
    reading: ExtractionReading,
    seed: int,
) -> ObservedSurface:
    """The points of the cloud, their colors, confidences and the views that are surest.

    confident: the cloud points whose confidence (13) is at least `least_confidence`.
    surface: where pixels see the surface, if they are as sure, one point a cell of side `spacing`.
    fused: on the surface on which the views agree, drawn by `seed` (`fused.fused`).
    """
    min_confidence = settings.min_confidence
    match reading:
        case "confident_points":
            is_confident = view_confidence.confidence >= max(
                min_confidence, torch.finfo(torch.float32).tiny
            )
            return ObservedSurface(
                points[is_confident],
                rgb[is_confident],
                view_confidence.confidence[is_confident],
                view_confidence.view[is_confident],
            )
        case "surface_points":
            return voxel_downsample(
                view_confidence.surface.select(
                    view_confidence.surface.confidence >= min_confidence
                ),
                settings.surface_spacing,
            )
        case "tsdf_fusion":
            return fuse_surface(view_confidence.surface, posed, settings, seed)
        case _:
            assert_never(reading)
