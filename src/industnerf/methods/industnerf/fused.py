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

from industnerf.geometry.cameras import projections_from_ball, reduced_size
from industnerf.geometry.fusion import UNKNOWN, fuse
from industnerf.geometry.isosurface import isosurface_points
from industnerf.methods.industnerf.scene import Posed
from industnerf.methods.industnerf.witnesses import Surface, thinned
from industnerf.schema import IndustnerfSettings

Projections = Float32[np.ndarray, "v 3 4"]


def fused(surface: Surface, posed: Posed, ways: IndustnerfSettings, seed: int) -> Surface:
    """Area-uniform points of the surface on which the views agree, in the unit frame; maybe none.

    `surface` has the point where each pixel's ray meets the field; a pixel that has none sees
    nothing.  Pixels less sure than `least_confidence` say nothing.  A point has the colour, the
    confidence and the view of the pixels next to it; if there are none, confidence 0 and view -1.
    """
    grid_res, spacing = ways.fusion.grid_res, 2 / ways.fusion.grid_res
    sure = surface.confidence >= ways.least_confidence
    seen = on_cpu(thinned(surface.only(sure), spacing))
    if not len(seen.points):
        return seen
    depth, projections = depth_images(on_cpu(surface), sure.cpu().numpy(), posed, ways.surface_px)
    reach = ways.fusion.truncation * spacing
    values = fuse(depth, projections, grid_res, reach)
    lo, rng = np.full(3, spacing / 2 - 1), np.random.default_rng(seed)
    points = isosurface_points(values, 0.0, lo, spacing, ways.fusion.points, rng)
    return described(points, seen, reach)


def on_cpu(surface: Surface) -> Surface:
    """The same, where SciPy's kin can read it."""
    return Surface(*(values.cpu() for values in vars(surface).values()))


def depth_images(
    surface: Surface, sure: Bool[np.ndarray, "n"], posed: Posed, longest: int
) -> tuple[Float32[np.ndarray, "v h w"], Projections]:
    """What each view sees of `surface`, the longer side of its image `longest` px; 0 is nothing."""
    width, height = posed.cameras.width, posed.cameras.height
    wide, tall = reduced_size(width, height, longest)
    projections = projections_from_ball(posed.cameras, posed.centre, posed.radius)
    projections[:, 0] *= wide / width
    projections[:, 1] *= tall / height
    depth = np.zeros((len(projections), tall, wide), np.float32)
    points, view = surface.points.numpy(), surface.view.numpy()
    for which, (image, projection) in enumerate(zip(depth, projections, strict=True)):
        own = view == which
        u, v, z = projection[:, :3] @ points[own].T + projection[:, 3:]
        row, column = (v / z).astype(int), (u / z).astype(int)  # the points are on rays of pixels
        image[row, column] = np.where(sure[own], z, UNKNOWN)
    return depth, projections


def described(points: Float[np.ndarray, "n 3"], pixels: Surface, reach: float) -> Surface:
    """`points` with what the nearest of `pixels` says; beyond `reach` none is sure of anything."""
    if not len(points):
        return pixels.only(torch.zeros(len(pixels.points), dtype=torch.bool))
    away, nearest = KDTree(pixels.points.double().numpy()).query(points.astype(np.float64))
    near, told = torch.from_numpy(away <= reach), torch.from_numpy(nearest.astype(np.int64))
    return Surface(
        torch.from_numpy(points).float(),
        pixels.rgb[told],
        torch.where(near, pixels.confidence[told], 0.0),
        torch.where(near, pixels.view[told], -1),
    )
