"""Resolution of the first grid, for parts that fill little of their bounding ball.

In the paper r is the same for all parts (3.1).
"""

from dataclasses import replace

from industnerf.methods.industnerf.point_levels import grid_spacing, initial_grid
from industnerf.methods.industnerf_plus.sdf_constraints import HULL_MARGIN
from industnerf.methods.industnerf_plus.silhouette_carving import Silhouettes
from industnerf.schema import IndustnerfPlusSettings

MAX_REFINEMENT = 2.0  # times as fine as `grid_res`


def adapt_resolution(
    settings: IndustnerfPlusSettings, silhouettes: Silhouettes
) -> IndustnerfPlusSettings:
    """`settings` with the largest `grid_res` of at most `max_grid_points` points in the hull.

    If m points are in it at r, there are at most (r' / r)^3 m at r'.  `beta.start` is scaled, so
    that the surface is as soft in the unit frame as before.
    """
    if not settings.max_grid_points:
        return settings
    spacing = grid_spacing(settings.grid_res, 0)
    points = initial_grid(spacing, silhouettes.device)
    num_inside = int(silhouettes.inside_hull(points, hull_margin(settings) * spacing).sum())
    refinement = min((settings.max_grid_points / max(num_inside, 1)) ** (1 / 3), MAX_REFINEMENT)
    if refinement <= 1:
        return settings
    divisor = 2 if settings.warm_up.steps else 1
    grid_res = int(refinement * settings.grid_res) // divisor * divisor
    beta_start = settings.beta.start * grid_res / settings.grid_res
    return replace(settings, grid_res=grid_res, beta=replace(settings.beta, start=beta_start))


def hull_margin(settings: IndustnerfPlusSettings) -> float:
    """How far beyond the hull points are kept, in spacings."""
    return HULL_MARGIN if settings.sdf.enabled else 0.9
