"""Section 3.4, from confidence to the final point cloud: reading R11.

Under `tsdf_fusion` the cloud is of the surface on which the depths of all views agree.  A pixel
tells where its ray meets the surface, and that space before it is empty.  The field is rough, and
no two views meet it in the same place; the mean of their signed distances is smoother than each.
The border of the space that is seen empty counts as surface even where no pixel sees it, such as
the wall of a deep bore.
"""

from typing import assert_never

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32
from pykdtree.kdtree import KDTree
from torch import Tensor

from industnerf.geometry.cameras import reduced_size, unit_ball_projections
from industnerf.geometry.isosurface import isosurface_points
from industnerf.geometry.tsdf import UNKNOWN, fuse
from industnerf.methods.industnerf.confidence import (
    ObservedSurface,
    ViewConfidence,
    voxel_downsample,
)
from industnerf.methods.industnerf.scene import PosedImages
from industnerf.schema import IndustnerfSettings
from industnerf.schema.readings import ExtractionReading

Projections = Float32[np.ndarray, "v 3 4"]


def extract_point_cloud(
    points: Float32[Tensor, "m 3"],
    rgb: Float32[Tensor, "m 3"],
    view_confidence: ViewConfidence,
    posed: PosedImages,
    settings: IndustnerfSettings,
    reading: ExtractionReading,
    seed: int,
) -> ObservedSurface:
    """The points of the cloud, with their colors, confidences and most confident views.

    confident_points: the cloud points with a confidence (13) of at least `min_confidence`.
    surface_points: where pixels as confident see the surface, one a voxel of `surface_spacing`.
    tsdf_fusion: samples of the surface on which the views agree, drawn by `seed`.
    """
    min_confidence, surface = settings.min_confidence, view_confidence.surface
    match reading:
        case "confident_points":
            minimum = max(min_confidence, torch.finfo(torch.float32).tiny)
            is_confident = view_confidence.confidence >= minimum
            return ObservedSurface(
                points[is_confident],
                rgb[is_confident],
                view_confidence.confidence[is_confident],
                view_confidence.view[is_confident],
            )
        case "surface_points":
            is_confident = surface.confidence >= min_confidence
            return voxel_downsample(surface.select(is_confident), settings.surface_spacing)
        case "tsdf_fusion":
            return fuse_surface(surface, posed, settings, seed)
        case _:
            assert_never(reading)


def fuse_surface(
    surface: ObservedSurface, posed: PosedImages, settings: IndustnerfSettings, seed: int
) -> ObservedSurface:
    """Area-uniform points of the surface on which the views agree, in the unit frame; maybe none.

    `surface` has the point where each pixel's ray meets the field; a pixel without one sees empty
    space.  Pixels below `min_confidence` are ignored.  A point has the color, confidence and view
    of the nearest pixel; if none is near, confidence 0 and view -1.
    """
    grid_res, spacing = settings.fusion.grid_res, 2 / settings.fusion.grid_res
    is_confident = surface.confidence >= settings.min_confidence
    observed = to_cpu(voxel_downsample(surface.select(is_confident), spacing))
    if not len(observed.points):
        return observed
    depth, projections = render_depth_maps(
        to_cpu(surface), is_confident.cpu().numpy(), posed, settings.surface_px
    )
    truncation = settings.fusion.truncation * spacing
    values = fuse(depth, projections, grid_res, truncation)
    first_center, rng = np.full(3, spacing / 2 - 1), np.random.default_rng(seed)
    points = isosurface_points(values, 0.0, first_center, spacing, settings.fusion.points, rng)
    return transfer_attributes(points, observed, truncation)


def to_cpu(surface: ObservedSurface) -> ObservedSurface:
    """The same on the CPU."""
    return ObservedSurface(*(values.cpu() for values in vars(surface).values()))


def render_depth_maps(
    surface: ObservedSurface, is_confident: Bool[np.ndarray, "n"], posed: PosedImages, image_px: int
) -> tuple[Float32[np.ndarray, "v h w"], Projections]:
    """Depth map of each view, its longer side `image_px`, and its projection; 0: nothing there."""
    width, height = posed.cameras.width, posed.cameras.height
    map_width, map_height = reduced_size(width, height, image_px)
    projections = unit_ball_projections(posed.cameras, posed.center, posed.radius)
    projections[:, 0] *= map_width / width
    projections[:, 1] *= map_height / height
    depth = np.zeros((len(projections), map_height, map_width), np.float32)
    points, view_of_point = surface.points.numpy(), surface.view.numpy()
    for view_index, (image, projection) in enumerate(zip(depth, projections, strict=True)):
        in_view = view_of_point == view_index
        u, v, z = projection[:, :3] @ points[in_view].T + projection[:, 3:]
        row, column = (v / z).astype(int), (u / z).astype(int)  # the points are on rays of pixels
        image[row, column] = np.where(is_confident[in_view], z, UNKNOWN)
    return depth, projections


def transfer_attributes(
    points: Float[np.ndarray, "n 3"], observed: ObservedSurface, max_distance: float
) -> ObservedSurface:
    """`points` with the attributes of the nearest observed point, if within `max_distance`."""
    if not len(points):
        return observed.select(torch.zeros(len(observed.points), dtype=torch.bool))
    distances, nearest = KDTree(observed.points.double().numpy()).query(points.astype(np.float64))
    is_near = torch.from_numpy(distances <= max_distance)
    indices = torch.from_numpy(nearest.astype(np.int64))
    return ObservedSurface(
        torch.from_numpy(points).float(),
        observed.rgb[indices],
        torch.where(is_near, observed.confidence[indices], 0.0),
        torch.where(is_near, observed.view[indices], -1),
    )
