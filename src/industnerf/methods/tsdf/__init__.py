"""True depth images fused into a truncated signed distance -- Curless and Levoy (1996).

Given what no camera gives, this is a bound: it shows how much of a surface so many views know.
"""

import numpy as np

from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import framed_ball, projections_from_ball
from industnerf.geometry.fusion import fuse
from industnerf.geometry.isosurface import isosurface_points
from industnerf.methods.base import Given, Input, Method, Reconstruction, Role, Scope
from industnerf.schema import TsdfSettings


def reconstruct(given: Given, settings: TsdfSettings, state: None, seed: int) -> Reconstruction:
    """Area-uniform points on the surface of all that is not seen empty.

    Raises ReconstructionFailed if there is none.
    """
    centre, radius_mm = framed_ball(given.cameras)
    projection = projections_from_ball(given.cameras, centre, radius_mm)
    depth = (given.depth_mm / radius_mm).astype(np.float32)
    spacing = 2 / settings.grid_res
    values = fuse(depth, projection, settings.grid_res, settings.truncation * spacing)
    lo, rng = np.full(3, spacing / 2 - 1), np.random.default_rng(seed)
    points = isosurface_points(values, 0.0, lo, spacing, settings.points, rng)
    if not len(points) or not depth.any():
        raise ReconstructionFailed(
            f"no surface: {(depth > 0).sum()} pixels of {len(depth)} views show the part, and "
            f"{(values > 0).sum()} of {settings.grid_res}^3 cells are not seen empty; a part "
            "thinner than a cell needs a larger method.tsdf.grid_res"
        )
    return Reconstruction(centre + radius_mm * points)


METHODS = {
    "tsdf": Method(
        "tsdf",
        Scope.PART,
        frozenset({Input.DEPTH}),
        reconstruct,
        role=Role.BOUND,
        random=True,
    )
}
