"""True depth images fused into a truncated signed distance -- Curless and Levoy (1996).

No camera gives true depth, so this is a bound: how much of a surface so many views show.
"""

import numpy as np

from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import common_view_ball, unit_ball_projections
from industnerf.geometry.isosurface import isosurface_points
from industnerf.geometry.tsdf import fuse
from industnerf.methods.base import Input, Method, MethodInputs, Reconstruction, Role, Scope
from industnerf.schema import TsdfSettings


def reconstruct(
    inputs: MethodInputs, settings: TsdfSettings, state: None, seed: int
) -> Reconstruction:
    """Area-uniform points on the surface of all that is not seen empty.

    Raises ReconstructionFailed if there is none.
    """
    center, radius_mm = common_view_ball(inputs.cameras)
    projection = unit_ball_projections(inputs.cameras, center, radius_mm)
    depth = (inputs.depth_mm / radius_mm).astype(np.float32)
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
    return Reconstruction(center + radius_mm * points)


METHODS = {
    "tsdf": Method(
        "tsdf",
        Scope.PART,
        frozenset({Input.DEPTH}),
        reconstruct,
        role=Role.BOUND,
        is_stochastic=True,
    )
}
