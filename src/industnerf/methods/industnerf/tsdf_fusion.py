"""The surface on which the depths of all source views agree: reading `fused` of R11.

A pixel says where its ray meets the surface, and that there is nothing before.  The field is rough,
and no two views meet it in the same place: the mean of their signed distances is smoother than
what any of them sees.  What bounds the space that is seen empty is surface even where no pixel
looks at it, as the walls of a deep bore.
"""

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32
from pykdtree.kdtree import KDTree

from industnerf.geometry.cameras import reduced_size, unit_ball_projections
from industnerf.geometry.isosurface import isosurface_points
from industnerf.geometry.tsdf import UNKNOWN, fuse
from industnerf.methods.industnerf.scene import PosedImages
from industnerf.methods.industnerf.view_confidence import ObservedSurface, voxel_downsample
from industnerf.schema import IndustnerfSettings

Projections = Float32[np.ndarray, "v 3 4"]


def fuse_surface(
    surface: ObservedSurface, posed: PosedImages, settings: IndustnerfSettings, seed: int
) -> ObservedSurface:
    """Area-uniform points of the surface on which the views agree, in the unit frame; maybe none.

    `surface` has the point where each pixel's ray meets the field; a pixel that has none sees
    nothing.  Pixels less sure than `least_confidence` say nothing.  A point has the color, the
    confidence and the view of the pixels next to it; if there are none, confidence 0 and view -1.
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
    """The same, where SciPy's kin can read it."""
    return ObservedSurface(*(values.cpu() for values in vars(surface).values()))


def render_depth_maps(
    surface: ObservedSurface, is_confident: Bool[np.ndarray, "n"], posed: PosedImages, image_px: int
) -> tuple[Float32[np.ndarray, "v h w"], Projections]:
    """What each view sees of `surface`, the longer side of its image `longest` px; 0 is nothing."""
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
    """`points` with what the nearest of `pixels` says; beyond `reach` none is sure of anything."""
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
